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
    let mut ends_elsewhere = 0;
    for subject in [0, 4, 9] {
        let analysis = analysis(subject, Scenario::Rod);
        let levels = analysis.movement.levels();
        let ends = [Level::T12, Level::T6].map(|level| levels.index_of(level).expect("a level"));
        // A joint belongs to its upper vertebra.
        let region = |upper| ends.iter().filter(|&&end| upper > end).count();
        let groups = &analysis.model(LineKind::Inflection).expect("a model").groups;
        assert_eq!(groups.of_joint(), (1..levels.len()).map(region).collect::<Vec<_>>());
        let regions = analysis.movement.regions.bounds.map(|bounds| bounds.superior);
        ends_elsewhere += usize::from(regions[..2] != ends);
    }
    assert!(ends_elsewhere > 0, "some phantoms have their inflections elsewhere");
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

#[test]
fn stiffness_of_single_joints_is_not_fitted_to_ferguson_angles() {
    let case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("a phantom").case;
    let options = AnalysisOptions { grouping: Grouping::PerJoint, ..AnalysisOptions::paper() };
    let error = analyze(&case, &options).expect_err("three angles for fourteen joints");
    assert_eq!(error.code(), "ferguson_per_joint");
    assert!(error.to_string().contains("Ferguson angles"), "{error}");
}
