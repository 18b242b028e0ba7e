//! The table of all warnings.

use super::{Severity, Step};
use crate::anatomy::named;

/// A property that some warnings share.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// The film may not show the posture or the patient that it is named after.
    DoubtsFilm,
    /// Only the picture beside the case shows it, so that an analysis cannot find it again by itself.
    OfPicture,
}

/// Makes the enum from rows: the comment says when the warning is given.
macro_rules! warning_codes {
    ($($step:ident {$(
        #[doc = $meaning:literal]
        $code:ident = $key:literal: $severity:ident $(, $mark:ident)*;
    )*})*) => {
        named! {
            /// The code of a warning: it says which check or step gives the warning, and when.
            pub enum WarningCode {
                $($(#[doc = $meaning] $code = $key,)*)*
            }
        }

        impl WarningCode {
            /// The step that gives it.
            #[must_use]
            pub const fn step(self) -> Step {
                match self {
                    $($(Self::$code)|* => Step::$step,)*
                }
            }

            /// How bad it is.
            #[must_use]
            pub const fn severity(self) -> Severity {
                match self {
                    $($(Self::$code => Severity::$severity,)*)*
                }
            }

            const fn marks(self) -> &'static [Mark] {
                match self {
                    $($(Self::$code => &[$(Mark::$mark),*],)*)*
                }
            }
        }
    };
}

impl WarningCode {
    /// Whether the film may not show the posture or the patient that it is named after.
    #[must_use]
    pub fn doubts_film(self) -> bool {
        self.marks().contains(&Mark::DoubtsFilm)
    }

    /// Whether only the picture beside the case shows it, so that an analysis cannot find it again by itself.
    #[must_use]
    pub fn is_of_picture(self) -> bool {
        self.marks().contains(&Mark::OfPicture)
    }
}

warning_codes! {
    Measure {
        /// The bodies of a film have other proportions than on the erect film, beyond noise.
        AnotherPatient = "another_patient": Warning, DoubtsFilm;
        /// A model in space has no pedicles to take axial rotation from, and its curves are large enough to turn vertebrae.
        AxialRotationUnknown = "axial_rotation_unknown": Warning;
        /// An axis turned by hand differs much from the axis of the corners.
        AxisAgainstCorners = "axis_against_corners": Warning;
        /// L4, or L3 too, is not marked on every film, and the model stands on a higher vertebra.
        BaseMissing = "base_missing": Warning;
        /// A bending film shows the erect shape or its mirror image.
        BendKeepsShape = "bend_keeps_shape": Contradiction, DoubtsFilm;
        /// A bending film shows a bend to the other side.
        BendLeansAway = "bend_leans_away": Warning, DoubtsFilm;
        /// A bending film shows little or no lateral tilt towards its side.
        BendLeansLittle = "bend_leans_little": Warning;
        /// The bodies are so wide or so high that the pixels may not be as high as wide as stated.
        BodiesStretched = "bodies_stretched": Warning;
        /// Two opposite sides of a body differ much in length.
        BodySidesDiffer = "body_sides_differ": Warning;
        /// A reading says that some corners are completed, and lacks the landmarks to complete them from.
        CompletedWithoutLandmarks = "completed_without_landmarks": Warning;
        /// The columns or rows of a reading, or its locations, are whole tens, as a spreadsheet rounds them.
        CoordinatesRounded = "coordinates_rounded": Warning;
        /// A corner is far from where the two nearest vertebrae put it.
        CornerFarFromNeighbours = "corner_far_from_neighbours": Warning;
        /// A corner of one reading is far from the median of the readings.
        CornerFarFromReadings = "corner_far_from_readings": Warning;
        /// A program found corners that no person has accepted or moved.
        CornersNotReviewed = "corners_not_reviewed": Warning;
        /// The erect film shows a large lateral tilt of the spine.
        ErectLeans = "erect_leans": Warning, DoubtsFilm;
        /// A check doubts a film that a person compared with the patient's records.
        FilmChecked = "film_checked": Note;
        /// A film looks like the mirror image of its posture.
        FilmLooksMirrored = "film_looks_mirrored": Warning, DoubtsFilm;
        /// Two films show one shape, as two readings of one film do.
        FilmsShowOneShape = "films_show_one_shape": Warning, DoubtsFilm;
        /// Two pictures have one SOP Instance UID and different pixels.
        IdentifierRepeated = "identifier_repeated": Warning, OfPicture;
        /// The iliac crests of a film are not marked, and a line perpendicular to the base replaces the iliac line.
        IliacCrestsMissing = "iliac_crests_missing": Note;
        /// The iliac line is far from perpendicular to the base, as where the crests are exchanged, or the crests lie where no pelvis is.
        IliacLineUnusual = "iliac_line_unusual": Warning;
        /// A program found the landmarks of a reading and states its confidence.
        LandmarksByProgram = "landmarks_by_program": Note;
        /// Heights on the lateral and the erect film differ beyond noise.
        LateralHeightsDiffer = "lateral_heights_differ": Warning;
        /// The lateral film does not show every joint.
        LateralIncomplete = "lateral_incomplete": Warning;
        /// The thoracic spine is lordotic and the lumbar one kyphotic on the lateral film, as where front and back are exchanged.
        LateralLooksMirrored = "lateral_looks_mirrored": Warning;
        /// The lateral film shows no joint of the erect film.
        LateralNotMarked = "lateral_not_marked": Warning;
        /// The lateral film is turned against the erect film.
        LateralTurned = "lateral_turned": Warning;
        /// The spine or its bodies have a size that few patients have.
        LengthUnusual = "length_unusual": Warning;
        /// The spine on a film is longer or shorter than on the erect film, beyond what is usual.
        LengthsDiffer = "lengths_differ": Warning;
        /// A vertebra is not marked, and is interpolated between its neighbours.
        LevelInterpolated = "level_interpolated": Warning;
        /// The landmarks of T1 or L5 cannot be used, and the vertebra is left out.
        LevelLeftOut = "level_left_out": Warning;
        /// The levels were placed on a midline of the back surface, and no vertebra was seen.
        LevelsEstimated = "levels_estimated": Warning;
        /// The widths of the bodies match the neighbours on the erect film, or two readings of a film name its vertebrae one level apart.
        LevelsMayBeShifted = "levels_may_be_shifted": Warning, DoubtsFilm;
        /// A program found a corner of this vertebra with a low confidence.
        LowConfidence = "low_confidence": Warning;
        /// A film has no spacing, and its lengths are not in millimetres.
        NoSpacing = "no_spacing": Warning;
        /// The names of two observers differ by capitals, blanks and marks alone.
        ObserversAlike = "observers_alike": Warning;
        /// A DICOM file states another part of the body.
        OtherBodyPart = "other_body_part": Warning, DoubtsFilm, OfPicture;
        /// A DICOM file states another patient than the file of an earlier film.
        PatientDiffers = "patient_differs": Warning, DoubtsFilm, OfPicture;
        /// Both pedicles of a vertebra lie on one half of its body, or far above or below it.
        PediclesUnusual = "pedicles_unusual": Warning;
        /// The file beside the case is not the picture with the landmarks, by its SHA-256 or its size.
        PictureDiffers = "picture_differs": Warning, OfPicture;
        /// Two readings of a film place its vertebrae far apart.
        ReadingsApart = "readings_apart": Warning;
        /// Two readings of a film have the same landmarks, and count as one.
        ReadingsCopied = "readings_copied": Warning;
        /// Some readings of a film lack a vertebra that others have.
        ReadingsIncomplete = "readings_incomplete": Warning;
        /// Every film was read once, so that the reliability of the readings is not known.
        ReliabilityOneReading = "reliability_one_reading": Note;
        /// The lengths of a film are in another plane than on the erect film.
        SpacingPlanesDiffer = "spacing_planes_differ": Warning;
        /// Two neighbouring vertebrae are as far apart as where one was skipped or marked twice.
        SpacingUnusual = "spacing_unusual": Warning;
        /// T2 is not marked on every film, and the model ends at a lower vertebra.
        TopMissing = "top_missing": Warning;
    }
    Curve {
        /// No order of the curve gives exactly two inflections, and the order is chosen by leaving vertebrae out.
        NoOrderWithTwoInflections = "no_order_with_two_inflections": Warning;
        /// A vertebra is tilted so far that the curve is fitted in parametric form.
        ParametricCurve = "parametric_curve": Note;
        /// The tilts do not follow the curve through the locations.
        TiltsDisagreeWithLocations = "tilts_disagree_with_locations": Warning;
    }
    Clinical {
        /// A vertebra beside the end vertebra of a curve is not marked, and the angle of the curve may be too small.
        EndVertebraNotMarked = "end_vertebra_not_marked": Warning;
        /// The end vertebrae of a curve were given.
        EndVertebraeByHand = "end_vertebrae_by_hand": Note;
        /// The given end vertebrae of a curve lie on one side of its apex, or the erect film does not show both.
        EndVertebraeUnusual = "end_vertebrae_unusual": Warning;
        /// The erect curve or the model file does not give three regions, and the usual limits of regions are used.
        UsualRegions = "usual_regions": Note;
    }
    Motion {
        /// The two inflections were chosen by hand.
        InflectionsByHand = "inflections_by_hand": Note;
        /// The erect curve has more or fewer than two inflections.
        InflectionsNotTwo = "inflections_not_two": Warning;
    }
    Action {
        /// A given line passes the spine further away than a trunk reaches.
        GivenLineFar = "given_line_far": Warning;
        /// A film, or every bending film, has no line of action of this kind.
        NoLine = "no_line": Warning;
        /// The estimation of the lines of best fit to the rotations did not converge.
        BestFitLinesNotFound = "best_fit_lines_not_found": Warning;
    }
    Multibody {
        /// A simulation was interrupted, and its path so far is not a result.
        Interrupted = "interrupted": Warning;
        /// A joint of a simulated shape rotates further about one axis than a spine allows.
        LargeHinge = "large_hinge": Warning;
        /// A film has no spacing, and no model is fitted.
        NoScale = "no_scale": Warning;
        /// The films speak against the model of a simulation.
        ModelDoubted = "model_doubted": Warning;
        /// A pad pulls in a simulated shape, where a real pad loses contact.
        PadPulls = "pad_pulls": Warning;
        /// A simulation lost a path of equilibria, and there may be more shapes that meet the target.
        PathLost = "path_lost": Warning;
        /// Only ratios of the stiffness are known, and the loads of a simulation are not in newtons.
        RelativeForces = "relative_forces": Warning;
        /// Several shapes meet the target of a simulation.
        SeveralEquilibria = "several_equilibria": Warning;
        /// Pads and straps of a simulation are springs that do not lose contact.
        SpringsStick = "springs_stick": Warning;
        /// The springs of the table may be in another unit than N·m/rad, or relative, and no force is in newtons.
        StiffnessUnusual = "stiffness_unusual": Warning;
        /// A strap pushes in a simulated shape, where a real strap is slack.
        StrapPushes = "strap_pushes": Warning;
        /// The erect film has no picture, and the weight on it acts along the vertical of its frame.
        VerticalAssumed = "vertical_assumed": Warning;
        /// A simulation adds the weight of the patient to an erect shape that already carried it.
        WeightOnTop = "weight_on_top": Warning;
    }
    Personalize {
        /// The fit of a model did not converge.
        FitNotConverged = "fit_not_converged": Contradiction;
        /// Joints turn against the force beyond noise, which no positive stiffness explains.
        JointsContradictLine = "joints_contradict_line": Contradiction;
        /// The posture of the known force has no usable force, and the known force does not scale the stiffness.
        KnownForceUnused = "known_force_unused": Warning;
        /// A multiplier of stiffness reached its limit, so that its value is not identified.
        MultiplierAtBound = "multiplier_at_bound": Contradiction;
        /// The case has no bending film, and stiffness is not personalised.
        NoBendingFilm = "no_bending_film": Note;
    }
    Evaluate {
        /// The simulated shape is beyond the human range of motion, and is not a result.
        BeyondHumanRange = "beyond_human_range": Warning;
        /// No force reproduces the film, and the nearest shape is not a result.
        ForceNotFound = "force_not_found": Contradiction;
        /// The search for forces that reach the amplitude did not always converge, and there may be more.
        ForcesLost = "forces_lost": Warning;
        /// The analysis found no force for the film of a load, and a simulation uses the load whose shape came nearest.
        LoadNotFound = "load_not_found": Warning;
        /// The replicates were interrupted, and the finished ones count.
        ReplicatesInterrupted = "replicates_interrupted": Warning;
    }
}
