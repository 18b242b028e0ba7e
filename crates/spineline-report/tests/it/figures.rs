//! Every figure is made, contains the required texts, and has equal bytes each time.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::evaluate::Simulation;
use spineline::measure::{Film, FilmLandmarks, Placement, Reading, ReadingId, SpacingPlane};
use spineline::multibody::{PathEnding, Support};
use spineline::spatial::{Angle, Frontal};
use spineline_report::figures::{
    EstimateGroup, EstimateSample, InflectionSample, LocationErrorSample, case_overview,
    force_path, inflection_distances, least_rotating_estimates, location_errors,
    measured_and_simulated, profiles, rotations,
};
use spineline_report::paper::fitted_location_error_mm;

/// Turn of every vertebra against the one below, in degrees: three curves, scaled, and a bend of one side.
fn film(posture: Posture, scale: f64, bend_deg: f64) -> Film {
    let mut tilt = 0.0;
    let mut place = Frontal::default();
    let mut vertebrae = std::collections::BTreeMap::new();
    for (i, level) in Level::MODEL.into_iter().enumerate() {
        if i > 0 {
            let u = (i as f64 - 0.5) / 14.0;
            // Zero at u = 0.35 and 0.75: right, left and right again.
            let lobes = 330.0 * (u + 0.10) * (u - 0.35) * (u - 0.75) * (1.25 - u);
            let turn = scale * lobes + bend_deg * (1.0 + 0.5 * (9.0 * u).sin());
            let along = Frontal::leaning(Angle::from_deg(tilt + 0.5 * turn));
            tilt += turn;
            place = place + along * (32.0 - 0.8 * i as f64);
        }
        vertebrae.insert(level, Placement::new(place, Angle::from_deg(tilt)));
    }
    let readings = vec![Reading { id: ReadingId::new("A", 1), vertebrae }];
    Film::new(posture, FilmLandmarks::placed(SpacingPlane::Patient, readings))
}

fn analysis(synthetic: bool, postures: &[Posture]) -> Analysis {
    let make = |&posture: &Posture| match posture {
        Posture::Erect => film(posture, 1.0, 0.0),
        Posture::LeftBending => film(posture, 0.75, -2.2),
        Posture::RightBending => film(posture, 0.7, 2.0),
        Posture::Neutral => film(posture, 0.85, 0.15),
        Posture::Traction => film(posture, 0.6, -0.1),
    };
    let films = postures.iter().map(make).collect();
    let case = Case { synthetic, ..Case::of_films("test <1> & co", films) };
    analyze(&case, &AnalysisOptions::default()).expect("the case is sound")
}

fn shapes(analysis: &Analysis) -> Vec<(f64, Vec<Frontal>)> {
    let erect: Vec<Frontal> = analysis.movement.erect().outline.locations().collect();
    let bent: Vec<Frontal> = analysis
        .movement
        .film(Posture::RightBending)
        .expect("filmed")
        .outline
        .locations()
        .collect();
    [0.0, 0.4, 0.8, 1.0]
        .map(|part| {
            let mix = |(a, b): (&Frontal, &Frontal)| *a * (1.0 - part) + *b * (0.95 * part);
            (part, erect.iter().zip(&bent).map(mix).collect())
        })
        .to_vec()
}

/// Numbers without a pattern, from 0 to `most`, crowded near zero.
fn sample(n: u32, most: f64) -> Vec<f64> {
    (0..n).map(|i| most * f64::from(i * 7919 % n).powi(3) / f64::from(n).powi(3)).collect()
}

fn distances() -> Vec<InflectionSample> {
    [("rod", 4.0, 0.004), ("bend", 30.0, 0.03), ("pull", 220.0, 0.08)]
        .map(|(name, segments, deg)| InflectionSample {
            name: name.to_owned(),
            distances_segments: sample(144, segments),
            rotations_deg: sample(144, deg),
        })
        .to_vec()
}

fn errors() -> Vec<LocationErrorSample> {
    let lines = [(LineKind::Inflection, 3.0), (LineKind::Iliac, 9.0), (LineKind::Estimated, 2.0)];
    let of = |group: &str, factor: f64| {
        lines.map(|(line, most)| LocationErrorSample {
            group: group.to_owned(),
            line,
            errors_mm: sample(504, factor * most),
            paper: fitted_location_error_mm(line),
        })
    };
    [of("rod", 1.0), of("bend", 2.0), of("pull", 1.3)].concat()
}

fn estimates() -> Vec<EstimateGroup> {
    let of = |n, most| EstimateSample {
        distances_segments: sample(n, most),
        rotations_deg: sample(n, 0.01 * most),
    };
    let group = |name: &str, a, b| EstimateGroup {
        name: name.to_owned(),
        inflection: of(72, a),
        mean_least: of(72, b),
    };
    vec![group("left and right bending", 2.0, 2.2), group("neutral and traction", 2.0, 3.5)]
}

/// All figures by name.
fn figures(analysis: &Analysis) -> Vec<(String, String)> {
    let synthetic = analysis.synthetic;
    let mut all = vec![
        ("rotations".to_owned(), rotations(analysis).expect("moved postures")),
        (
            "inflection-distances".to_owned(),
            inflection_distances(&distances(), None, true, synthetic).expect("values"),
        ),
        (
            "location-errors".to_owned(),
            location_errors(&errors(), "bending films, fitted", synthetic).expect("values"),
        ),
        (
            "estimates".to_owned(),
            least_rotating_estimates(&estimates(), synthetic).expect("values"),
        ),
        ("overview".to_owned(), case_overview(analysis)),
    ];
    let posture = Posture::RightBending;
    let path =
        force_path(analysis, posture, LineKind::Inflection, &shapes(analysis), "× the final force");
    all.push(("force-path".to_owned(), path));
    for posture in Posture::MOVED {
        let svg = measured_and_simulated(analysis, posture).expect("simulated");
        all.push((format!("simulated-{}", posture.key()), svg));
    }
    all
}

/// Opening and closing tags match, and no `&` or `<` stands alone.
fn assert_well_formed(name: &str, svg: &str) {
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{name}");
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg;
    while let Some((_, tail)) = rest.split_once('<') {
        let (tag, after) = tail.split_once('>').expect("a tag ends");
        rest = after;
        let word = tag.trim_start_matches('/').split([' ', '/']).next().expect("a word");
        if tag.starts_with('!') || tag.ends_with('/') {
            continue;
        } else if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(word), "{name}");
        } else {
            open.push(word);
        }
    }
    assert!(open.is_empty(), "{name}");
    for (i, _) in svg.match_indices('&') {
        let known = ["&amp;", "&lt;", "&gt;", "&quot;", "&apos;"];
        assert!(known.iter().any(|entity| svg[i..].starts_with(entity)), "{name}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}: a coordinate is not finite");
}

#[test]
fn every_figure_has_units_and_the_label_synthetic() {
    let analysis = analysis(true, &Posture::ALL);
    for (name, svg) in figures(&analysis) {
        assert_well_formed(&name, &svg);
        assert!(svg.contains("synthetic"), "{name}");
        let units: &[&str] = match name.as_str() {
            "rotations" => &["(deg)", "segment number"],
            "inflection-distances" | "estimates" => &["(deg)", "(segments)"],
            _ => &["(mm)"],
        };
        assert!(units.iter().all(|unit| svg.contains(unit)), "{name}");
    }
}

#[test]
fn figures_of_real_films_have_no_label_synthetic() {
    for (name, svg) in figures(&analysis(false, &Posture::ALL)) {
        assert!(!svg.contains("synthetic"), "{name}");
    }
}

#[test]
fn equal_input_gives_equal_bytes() {
    let (first, second) = (analysis(true, &Posture::ALL), analysis(true, &Posture::ALL));
    assert_eq!(figures(&first), figures(&second));
}

#[test]
fn frontal_figures_name_the_direction_of_view() {
    let analysis = analysis(true, &Posture::ALL);
    for (name, svg) in figures(&analysis) {
        if name.starts_with("simulated") || name == "overview" || name == "force-path" {
            for words in ["Seen from behind", "LEFT", "RIGHT", " R<"] {
                assert!(svg.contains(words), "{name}: {words}");
            }
        }
    }
}

#[test]
fn a_shape_without_its_force_is_not_shown_as_a_result() {
    let mut analysis = analysis(true, &Posture::ALL);
    let posture = Posture::LeftBending;
    let set = |simulation: &mut Simulation, status| simulation.status = status;
    for model in &mut analysis.models {
        for simulation in model.simulations.iter_mut().filter(|s| s.shape.posture == posture) {
            set(simulation, PathEnding::Converged);
        }
    }
    let svg = measured_and_simulated(&analysis, posture).expect("simulated");
    assert!(!svg.contains("not a result") && svg.contains("(fitted)"));
    for simulation in &mut analysis.models[0].simulations {
        set(simulation, PathEnding::Unreachable);
        // A wild shape may not spoil the scale either.
        for location in &mut simulation.shape.locations {
            *location = *location * 5.0;
        }
    }
    let svg = measured_and_simulated(&analysis, posture).expect("simulated");
    assert_eq!(svg.matches("not a result (unreachable)").count(), 1);
    let held_out = measured_and_simulated(&analysis, Posture::Traction).expect("simulated");
    assert!(held_out.contains("(held out)") && !held_out.contains("(fitted)"));
}

#[test]
fn an_erect_film_alone_has_an_overview_only() {
    let analysis = analysis(true, &[Posture::Erect]);
    assert_eq!(rotations(&analysis), None);
    assert_eq!(measured_and_simulated(&analysis, Posture::LeftBending), None);
    assert_well_formed("overview", &case_overview(&analysis));
}

#[test]
fn samples_without_values_give_no_empty_panel() {
    assert_eq!(inflection_distances(&[], None, true, true), None);
    assert_eq!(location_errors(&[], "no films", true), None);
    assert_eq!(least_rotating_estimates(&[], true), None);
    let without = |line| LocationErrorSample {
        group: "rod".to_owned(),
        line,
        errors_mm: vec![f64::NAN],
        paper: None,
    };
    assert_eq!(location_errors(&[without(LineKind::Iliac)], "no films", true), None);
    let some = LocationErrorSample { errors_mm: vec![1.0, 2.0], ..without(LineKind::Inflection) };
    let svg = location_errors(&[some, without(LineKind::Iliac)], "some films", true);
    let svg = svg.expect("one line has errors");
    assert!(svg.contains("n = 2") && !svg.contains("n = 0") && !svg.contains("iliac"));
    let bends = estimates().swap_remove(0);
    let none = EstimateGroup {
        name: "no films".to_owned(),
        inflection: EstimateSample::default(),
        mean_least: EstimateSample::default(),
    };
    let svg = least_rotating_estimates(&[bends, none], true).expect("the bends have values");
    assert!(!svg.contains("no films") && !svg.contains("n = 0"));
}

/// Texts of a figure that are numbers alone: the labels of its ticks, and counts.
fn numbers(svg: &str) -> Vec<f64> {
    let text = |part: &str| Some(part.split('<').next()?.replace('−', "-"));
    svg.split('>').filter_map(|part| text(part)?.parse().ok()).collect()
}

#[test]
fn a_value_far_away_is_counted_and_does_not_flatten_the_boxes() {
    let mut errors_mm = sample(100, 3.0);
    let of = |errors_mm: &[f64]| LocationErrorSample {
        group: "all".to_owned(),
        line: LineKind::Iliac,
        errors_mm: errors_mm.to_vec(),
        paper: None,
    };
    let most = |svg: &str| numbers(svg).into_iter().fold(0.0, f64::max);
    let without = location_errors(&[of(&errors_mm)], "left out", false).expect("values");
    errors_mm.extend([240.0, 180.0]);
    let with = location_errors(&[of(&errors_mm)], "left out", false).expect("values");
    assert!(most(&with) <= 2.0 * most(&without), "{} {}", most(&with), most(&without));
    assert!(with.contains(">2 to 240<") && !without.contains(" to "));
}

#[test]
fn the_papers_means_stand_beside_ours_where_it_gives_them() {
    let legend = "the paper: mean ± standard deviation";
    let with = location_errors(&errors(), "bending films, fitted", true).expect("values");
    let of_others =
        errors().into_iter().map(|sample| LocationErrorSample { paper: None, ..sample });
    let without = location_errors(&of_others.collect::<Vec<_>>(), "others", true).expect("values");
    assert!(with.contains(legend) && !without.contains(legend));
    let [paper, alone] =
        [true, false].map(|with| inflection_distances(&distances(), None, with, true));
    let (paper, alone) = (paper.expect("values"), alone.expect("values"));
    for legend in [legend, "the paper: share"] {
        assert!(paper.contains(legend) && !alone.contains(legend), "{legend}");
    }
}

#[test]
fn spines_of_a_model_name_its_support() {
    let mut analysis = analysis(false, &Posture::ALL);
    for support in Support::ALL {
        analysis.options.support = support;
        let words = format!("Support of the model: {support}.");
        let figures = [
            case_overview(&analysis),
            measured_and_simulated(&analysis, Posture::LeftBending).expect("simulated"),
            force_path(&analysis, Posture::LeftBending, LineKind::Inflection, &[], "N"),
        ];
        assert!(figures.iter().all(|svg| svg.contains(&words)), "{words}");
    }
}

#[test]
fn many_boxes_are_named_in_the_legend() {
    let few = location_errors(&errors(), "bending films, fitted", true).expect("values");
    assert!(few.contains("n = 504"));
    let mut many = Vec::new();
    for more in ["", ", later", ", again"] {
        for sample in errors() {
            many.push(LocationErrorSample { group: sample.group.clone() + more, ..sample });
        }
    }
    let svg = location_errors(&many, "all films", true).expect("values");
    assert!(!svg.contains("n = 504") && svg.contains(">504<") && svg.contains("in the legend"));
}

#[test]
fn a_profile_has_a_panel_per_converged_line_and_a_name_per_multiplier() {
    let analysis = analysis(true, &Posture::ALL);
    let found: Vec<_> =
        analysis.models.iter().map(|model| analysis.identifiability(model)).collect();
    let svg = profiles(&analysis, &found).expect("converged fits");
    assert!(svg.to_lowercase().contains("synthetic"));
    assert_eq!(svg.matches("rise of the sum of squares").count(), found.iter().flatten().count());
    for name in analysis.models[0].groups.titles() {
        assert!(svg.contains(&name), "{name}");
    }
    assert_eq!(svg, profiles(&analysis, &found).expect("the same"));
    assert_eq!(profiles(&analysis, &vec![None; found.len()]), None);
}

#[test]
fn the_picture_of_the_guide_is_the_one_that_the_code_draws() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/src/lateral-bias.svg");
    let again =
        "cargo run -p spineline-report --example lateral_bias > docs/guide/src/lateral-bias.svg";
    let kept = std::fs::read_to_string(path).expect(again);
    assert!(kept == spineline_report::figures::lateral_bias(), "out of date: {again}");
}
