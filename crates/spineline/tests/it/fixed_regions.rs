//! Regions of the stiffness that do not follow the inflections.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Grouping, analyze};
use spineline::anatomy::Level;
use spineline::cohort::PatientClaims;
use spineline_phantom::{Readers, Scenario, generate};

fn analysis(subject: usize, scenario: Scenario) -> Analysis {
    let case = generate(subject, scenario, &Readers::exact(), 1).expect("a phantom").case;
    let grouping = Grouping::FixedRegions;
    analyze(&case, &AnalysisOptions { grouping, ..AnalysisOptions::default() }).expect("sound")
}

#[test]
fn fixed_regions_end_at_t12_and_t6_and_not_at_the_inflections() {
    let analysis = analysis(0, Scenario::Rod);
    let levels = analysis.movement.levels();
    let place = |level| levels.index_of(level).expect("a vertebra of the model");
    // A joint belongs to its upper vertebra.
    let [low, high] = [place(Level::T12), place(Level::T6)];
    let groups = &analysis.model(LineKind::Inflection).expect("a model").groups;
    let expected: Vec<usize> = (1..levels.len())
        .map(|upper| usize::from(upper > low) + usize::from(upper > high))
        .collect();
    assert_eq!(groups.of_joint(), expected);
    let at_inflections = analysis.movement.regions.bounds.map(|bounds| bounds.superior);
    assert_ne!(at_inflections[..2], [low, high], "this phantom has its inflections elsewhere");
}

#[test]
fn the_line_that_made_the_films_stays_ahead_with_fixed_regions() {
    for subject in [0, 4, 9] {
        let rod = PatientClaims::of(&analysis(subject, Scenario::Rod)).held_out_mm;
        let [inflection, iliac] = rod.expect("two lines");
        assert!(inflection < iliac, "subject {subject}: {inflection} and {iliac} mm");
        let pull = PatientClaims::of(&analysis(subject, Scenario::Pull)).fitted_mm;
        let [inflection, iliac] = pull.expect("two lines");
        assert!(iliac < inflection, "subject {subject}: {iliac} and {inflection} mm");
    }
}
