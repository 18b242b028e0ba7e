//! What clinicians read off the films, between the vertebrae that each film shows: the model may have fewer.

use super::AnalysisOptions;
use super::checks::{note_given_ends, warn_of_unmarked_ends};
use super::inflections::inflections_of;
use crate::clinical::{
    Balance, ClinicalCurve, LenkeType, Regions, lenke_type, measure_balance, measure_curves,
    measure_largest_curve,
};
use crate::curve::fit_curve;
use crate::error::Error;
use crate::measure::Outline;
use crate::spatial::Frontal;
use crate::warning::Warnings;

pub(super) struct Clinic {
    /// Of the regions.
    pub curves: Vec<ClinicalCurve>,
    /// The largest one, where the regions are not curves and the user has picked no end vertebra.
    pub whole_curve: Option<ClinicalCurve>,
    pub balance: Option<Balance>,
    pub lenke: Option<LenkeType>,
}

impl Clinic {
    /// Of the films, the erect one first, and of the regions of the model.
    pub fn of(
        films: &[Outline],
        of_model: Regions,
        options: &AnalysisOptions,
        warnings: &mut Warnings,
    ) -> Result<Self, Error> {
        let (erect, all) = (&films[0], films.iter().collect::<Vec<_>>());
        let regions = if erect.levels().joints() == of_model.joints() {
            of_model
        } else {
            // The model gave the warnings about the curve already.
            let repeated = &mut Warnings::default();
            let fit = fit_curve(erect, options.order_rule, repeated)?;
            let inflections = inflections_of(&fit, options, repeated);
            let locations: Vec<Frontal> = erect.locations().collect();
            Regions::from_inflections(&fit, &inflections, &locations, repeated)
        };
        let curves = measure_curves(&regions, &all, &options.ends);
        warn_of_unmarked_ends(&curves, warnings);
        let given = &options.ends.given;
        let ends_fit = note_given_ends(given, &curves, regions.are_curves, warnings);
        let picked = given.iter().any(Option::is_some);
        let is_whole = !regions.are_curves && !picked;
        Ok(Self {
            whole_curve: is_whole.then(|| measure_largest_curve(&all, options.ends.rule)).flatten(),
            balance: measure_balance(erect, &regions, &curves),
            // Regions that end at usual vertebrae are not curves, so they give no type.
            lenke: (regions.are_curves && ends_fit).then(|| lenke_type(&curves)).flatten(),
            curves,
        })
    }
}
