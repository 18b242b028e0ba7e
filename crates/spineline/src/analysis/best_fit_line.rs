//! The line of best fit to the rotations of a film, and its comparison with a candidate.

use std::fmt;

use crate::action::LineOfAction;
use crate::number::{fixed, interval};
use crate::personalize::{Crossing, LineTest};
use crate::spatial::Angle;

/// The line of best fit to the rotations of one film.
#[derive(Debug, Clone, PartialEq)]
pub struct BestFitLine {
    /// The line; its direction is cranial.
    pub line: LineOfAction,
    /// Where it crosses the heights of the inflections (without inflections: of L4 and T2), each with 95 % confidence.
    pub crossings: [LineCrossing; 2],
    /// Against the line through the inflections.
    pub inflection: Option<LineComparison>,
    /// Against the iliac line, which is tested for its direction alone; `None` where no crests are marked.
    pub iliac: Option<LineComparison>,
    /// Against the line that was given for this film, which is taken as exact.
    pub given: Option<LineComparison>,
    /// Deviation of `ln` stiffness among the joints of a region, shared by all films.
    pub joint_log_sd: f64,
}

/// A place of a line at a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineCrossing {
    /// Height.
    pub z_mm: f64,
    /// Place to the patient's left; infinite for a line along the height.
    pub y_mm: f64,
    /// Its 95 % interval.
    pub within: Crossing,
}

impl fmt::Display for LineCrossing {
    /// The place in mm to the patient's left, and its 95 % interval in brackets.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.within {
            Crossing::Between([low, high]) => {
                f.pad(&format!("{} ({})", fixed(self.y_mm, 0), interval([low, high], 0)))
            }
            Crossing::Open => f.pad("anywhere"),
        }
    }
}

/// How far the line of best fit to the rotations of a film lies from a proposed one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineComparison {
    /// Angle between the lines.
    pub angle: Angle,
    /// Distance of the line of best fit from a point of the other: the middle of the two inflections, T2 (the top) for the iliac
    /// line, and for a given line its point nearest to the middle of the spine.
    pub distance_mm: f64,
    /// Of "it runs through both inflections", "it is parallel to the iliac line" or "it is the given line".
    pub test: LineTest,
}
