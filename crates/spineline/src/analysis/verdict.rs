use super::analyze::counted;
use super::{Analysis, LineModel, PostureAnalysis};
use crate::action::LineKind;
use crate::evaluate::Simulation;

/// More of the joints' work than this against the force speaks against a line.
const WEIGHT_AGAINST: f64 = 0.10;

impl Analysis {
    /// What the data say of the lines of action, in plain sentences.
    ///
    /// First whether the bends are compatible with a single force through the inflections, then which line reproduces
    /// the fitted films best, and apart from that which one predicts the held-out films best.
    #[must_use]
    pub fn verdict(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        if self.models.is_empty() {
            let why = if self.warnings.has("no_scale") {
                "Without a spacing on every film there are angles, but no lengths and no model."
            } else {
                "No bending film: the curve is measured, but no stiffness can be fitted."
            };
            sentences.push(why.to_owned());
            return sentences;
        }
        match self.models.iter().find(|model| model.kind == LineKind::Inflection) {
            Some(model) => sentences.extend(self.inflection_verdict(model)),
            None if self.inflections.pair.is_some() => {
                sentences.push("There is no inflection line: the warnings say why.".to_owned())
            }
            None => sentences.push(format!(
                "There is no inflection line: the erect curve has {} with lobes of {} or more.",
                counted(self.inflections.all.len()),
                self.options.min_lobe
            )),
        }
        sentences.extend(self.postures.iter().filter_map(turning_sentence));
        sentences.extend(self.best(true).map(|(model, error_mm)| {
            format!(
                "The {} reproduces the fitted bends best: {error_mm:.1} mm on average{}.",
                model.kind,
                if model.kind == LineKind::Estimated {
                    ", with two more numbers fitted per bend"
                } else {
                    ""
                }
            )
        }));
        sentences.extend(self.best(false).map(|(model, error_mm)| {
            let caveat = match model.kind {
                LineKind::Estimated => ", its line taken from those films",
                _ => "",
            };
            format!(
                "The {} predicts the held-out films best: {error_mm:.1} mm on average{caveat}.",
                model.kind
            )
        }));
        sentences
    }

    fn inflection_verdict(&self, model: &LineModel) -> Vec<String> {
        let bends: Vec<&Simulation> =
            model.postures.iter().filter(|s| s.posture.bend().is_some()).collect();
        let mut sentences = Vec::new();
        for bend in &bends {
            let beyond = bend.contradicted.iter().filter(|joint| joint.beyond_noise).count();
            let weight = bend.contradicted_weight();
            let joints = bend.location_errors_mm.len();
            if beyond > 0 && weight > WEIGHT_AGAINST {
                sentences.push(format!(
                    "The {} is not compatible with a single force through the inflections: {} of {joints} joints turn against it, {beyond} of them beyond noise, with {:.0} % of the work.",
                    bend.posture, bend.contradicted.len(), 100.0 * weight
                ));
            }
        }
        let tested = self.postures.iter().filter(|p| p.outline.posture.bend().is_some());
        for (posture, test) in
            tested.filter_map(|p| p.line_comparison().map(|c| (p.outline.posture, c)))
        {
            if test.test.rejects() {
                sentences.push(format!(
                    "In the {posture} the load that the joints' rotations prefer runs {:.0} mm from the middle of the inflections and {:.0}° off their line (p {}).",
                    test.distance_mm, test.angle.deg(), probability(test.test.p_value)
                ));
            }
        }
        if sentences.is_empty() && !bends.is_empty() {
            sentences.push(
                "The bends do not speak against a single force through the inflections.".to_owned(),
            );
        }
        sentences
    }

    /// The model with the least mean location error over fitted or held-out films.
    fn best(&self, fitted: bool) -> Option<(&LineModel, f64)> {
        let errors = self
            .models
            .iter()
            .filter_map(|model| Some((model, model.mean_location_error_mm(fitted)?)));
        errors.min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// How many joints turn the way of the bend. A single force that crosses the spine twice turns them both ways.
fn turning_sentence(posture: &PostureAnalysis) -> Option<String> {
    let side = posture.outline.posture.bend()?;
    let joints = &posture.evidence.as_ref()?.joints;
    let same = joints.iter().filter(|joint| joint.rotation.side() == Some(side)).count();
    let name = posture.outline.posture;
    Some(format!("In the {name} {same} of {} joints turn to the {side}.", joints.len()))
}

/// A probability as people print it: never as zero.
#[must_use]
pub fn probability(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".to_owned() } else { format!("= {p:.4}") }
}
