//! Reports contain the required texts, escape user text, and embed their analysis.

use spineline::analysis::{
    Analysis, AnalysisOptions, Case, FilmPredictor, FilmRole, Subject, analyze,
};
use spineline::anatomy::Level;
use spineline::cohort::{RefusalStep, RefusedCase};
use spineline::evaluate::Baseline;
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::{PathEnding, Support};
use spineline_phantom::{SagittalShape, Scenario, SpaceSetup, generate_in_space};
use spineline_report::document::{Block, NoticeKind, Section, Table};
use spineline_report::{Document, embedded, html, markdown, patient, png};

use crate::common::{self, analyzed, cohort_report, figure_names, section, shown};

const HOSTILE: [&str; 6] = [
    "<script>alert(1)</script>",
    "| a | *b* `c` $d$ [e](f)",
    "#eval(\"1\") @label \\ ~ _x_",
    "病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例病例",
    "\u{202e}مريض رقم ١",
    "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef",
];
/// Something that ends elements, comments and fences, as a JSON text may hold it.
pub const JSON: &str =
    r#"{"case_id":"</script><!-- ``` ``````json spineline-analysis \\u003c","n":1.5}"#;

fn case(subject: usize) -> Case {
    common::case(subject, Scenario::Rod)
}

pub fn document(case: &Case) -> Document {
    patient::report(&shown(case, &analyzed(case), JSON))
}

fn cohort_document(refused: &[RefusedCase]) -> Document {
    let cases: Vec<Case> = (0..3).map(case).collect();
    let analyses: Vec<Analysis> = cases.iter().map(analyzed).collect();
    let subjects: Vec<Subject> = cases.iter().map(|case| case.subject.clone()).collect();
    cohort_report(&analyses, &subjects, refused)
}

pub fn named(name: &str) -> Case {
    Case { id: name.to_owned(), ..case(0) }
}

pub fn tables(section: &Section) -> Vec<&Table> {
    let mut found = Vec::new();
    for block in &section.blocks {
        if let Block::Table(table) = block {
            found.push(table);
        }
    }
    found
}

#[test]
fn page_one_sets_every_line_beside_predictions_without_mechanics() {
    let case = case(0);
    let document = document(&case);
    let short = section(&document, "short");
    let compared = analyzed(&case).comparison().clone();
    let sentences: Vec<&String> = short
        .blocks
        .iter()
        .filter_map(|block| if let Block::Paragraph(text) = block { Some(text) } else { None })
        .collect();
    assert_eq!(sentences.len(), 4, "{sentences:?}");
    // A rod obeys the paper's line and no other.
    assert!(sentences[1].contains("reject a single force along the iliac line"));
    assert!(sentences[1].contains("keep one along the inflection line"));
    let best = "the inflection line has the smallest error on bends left out of the fit";
    assert!(sentences[2].contains(best));
    assert!(sentences[3].contains("With the inflection line, the fit finds 3 of 3"));
    let table = tables(short)[0];
    assert_eq!(table.rows.len(), compared.lines.len() + 4);
    for (i, row) in table.rows.iter().enumerate().take(compared.lines.len()) {
        let errors = compared.errors(i, FilmRole::LeftOutBend).expect("two bends");
        assert_eq!(row[2], format!("{:.1}", errors.location_mm));
    }
    let mirrored =
        compared.error_mm(FilmPredictor::Baseline(Baseline::MirroredBend), FilmRole::LeftOutBend);
    let rows = table.rows.iter().filter(|row| row[0].starts_with("* "));
    assert!(rows.clone().any(|row| row[2] == format!("{:.1}", mirrored.expect("two bends"))));
    assert!(short.blocks.iter().any(|block| matches!(block, Block::Figure(_))));
}

#[test]
fn a_patient_report_has_every_section_and_the_main_finding_first() {
    let document = document(&case(0));
    let ids: Vec<&str> = document.sections.iter().map(|section| section.id).collect();
    assert_eq!(
        ids,
        [
            "short",
            "verdict",
            "films",
            "movement",
            "line",
            "simulated",
            "space",
            "stiffness",
            "errors",
            "comparison",
            "method"
        ]
    );
    assert!(document.sections.iter().all(|section| !section.blocks.is_empty()));
    assert!(document.banners[0].text.contains("Synthetic"));
    assert!(document.banners[1].text.contains("not a medical device"));
    let names = figure_names(&document);
    for name in [
        "films",
        "rotations",
        "inflections",
        "line",
        "space",
        "simulated-traction",
        "force-left_bending",
    ] {
        assert!(names.contains(&name), "{name}");
    }
    for figure in document.figures() {
        assert!(figure.svg.contains("synthetic"), "{}", figure.name);
        assert!(!figure.svg.contains("NaN"), "{}", figure.name);
    }
}

#[test]
fn a_banner_names_the_options_that_differ_from_the_defaults() {
    let case = case(0);
    assert_eq!(document(&case).banners.len(), 2, "the defaults have none");
    let options = AnalysisOptions {
        support: Support::Free,
        tilt: TiltRule::Axis,
        ..AnalysisOptions::default()
    };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let banners = patient::report(&shown(&case, &analysis, JSON)).banners;
    let text = &banners[2].text;
    for part in ["not the defaults", "Support: free: every joint", "Tilts: axis: line"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("gauge") && !text.contains("Stiffness"), "{text}");
    let cohort = cohort_report(&[analysis], std::slice::from_ref(&case.subject), &[]);
    assert_eq!(cohort.banners[2].text, *text);
    let film_lengths = FilmLengthRule::AsMarked;
    let options = AnalysisOptions { film_lengths, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    let banners = patient::report(&shown(&case, &analysis, JSON)).banners;
    assert!(banners[2].text.contains("one scale for all"), "{}", banners[2].text);
}

#[test]
fn a_banner_names_the_papers_method_and_what_differs_from_it() {
    let case = case(0);
    let banner = |options: &AnalysisOptions| {
        let analysis = analyze(&case, options).expect("a phantom is sound");
        patient::report(&shown(&case, &analysis, JSON)).banners[2].text.clone()
    };
    let paper = AnalysisOptions::paper();
    assert_eq!(banner(&paper), "Method: the paper's.");
    let frontal = banner(&AnalysisOptions { support: Support::Frontal, ..paper });
    assert!(frontal.starts_with("Method: the paper's, except for: Support: frontal"), "{frontal}");
    assert!(!frontal.contains("Tilts"), "{frontal}");
}

#[test]
fn a_lateral_film_adds_the_spine_in_space() {
    let setup = SpaceSetup { pedicles: true, ..SpaceSetup::default() };
    let case = generate_in_space(&setup).case;
    let document = document(&case);
    assert_eq!(tables(section(&document, "axial-rotation"))[0].rows.len(), Level::ALL.len());
    let found = section(&document, "both-films");
    let text = format!("{:?}", found.blocks);
    assert!(text.contains("The lateral film was aligned to the erect one"), "{text}");
    let [measures, pitches] = tables(found)[..] else { panic!("two tables") };
    assert_eq!(pitches.rows.len(), Level::ALL.len());
    assert!(measures.rows.iter().any(|row| row[0].starts_with("kyphosis T5–T12")));
    assert!(text.contains("the model would have the profile of a population"), "{text}");
    let assumed = pitches.rows.iter().filter(|row| row[5].replace('−', "-").parse::<f64>().is_ok());
    assert_eq!(assumed.count(), Level::MODEL.len(), "L5 and T1 are not of the model");
    let profile = document.figures().find(|figure| figure.name == "sagittal-profile");
    let svg = &profile.expect("a picture of the profile").svg;
    for part in ["synthetic", "From the right", "95 % interval", "T12", "population"] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(!svg.contains("NaN"));
}

#[test]
fn patients_with_lateral_films_are_shown_beside_the_population() {
    let mut cases: Vec<Case> = SagittalShape::ALL
        .iter()
        .map(|&shape| generate_in_space(&SpaceSetup { shape, ..SpaceSetup::default() }).case)
        .collect();
    cases[0].lateral = None;
    for (i, case) in cases.iter_mut().enumerate() {
        case.id = format!("patient-{i}");
    }
    let analyses: Vec<Analysis> = cases
        .iter()
        .map(|case| analyze(case, &AnalysisOptions::default()).expect("a phantom is sound"))
        .collect();
    let subjects: Vec<_> = cases.iter().map(|case| case.subject.clone()).collect();
    let document = cohort_report(&analyses, &subjects, &[]);
    let found = section(&document, "profiles");
    let text = format!("{:?}", found.blocks);
    assert!(text.contains("4 of 5 patients have a lateral film"), "{text}");
    let rows = &tables(found)[0].rows;
    assert_eq!(rows.len(), 4);
    assert!(rows.iter().all(|row| row[1] == "4"));
    let figure = document.figures().find(|figure| figure.name == "sagittal-profiles");
    let svg = &figure.expect("a picture of all profiles").svg;
    // Two panels with one line per patient each.
    assert_eq!(svg.matches("data-layer=\"patient\"").count(), 8);
    let without = cohort_report(&analyses[..1], &subjects[..1], &[]);
    assert!(without.sections.iter().all(|section| section.id != "profiles"));
}

#[test]
fn loads_and_bases_are_compared_where_they_were_requested() {
    let case = case(0);
    let hypotheses = ["inflection_line", "couple"].map(|name| name.parse().expect("a load"));
    let options = AnalysisOptions { hypotheses: hypotheses.to_vec(), ..AnalysisOptions::default() };
    let analyses = [analyze(&case, &options).expect("a phantom is sound")];
    let of_patient = patient::report(&shown(&case, &analyses[0], JSON));
    let of_cohort = cohort_report(&analyses, std::slice::from_ref(&case.subject), &[]);
    for document in [of_patient, of_cohort] {
        let found = section(&document, "hypotheses");
        assert!(found.title.starts_with("Loads and bases compared"), "{}", found.title);
        assert_eq!(tables(found)[0].rows.len(), 2, "one row per load");
    }
}

#[test]
fn contradictions_come_before_warnings_and_notes() {
    for subject in 0..4 {
        let document = document(&case(subject));
        let kinds: Vec<NoticeKind> = section(&document, "verdict")
            .blocks
            .iter()
            .filter_map(|block| match block {
                Block::Notice(notice) => Some(notice.kind),
                _ => None,
            })
            .collect();
        assert!(kinds.is_sorted(), "{kinds:?}");
    }
}

#[test]
fn fitted_and_held_out_errors_have_separate_tables() {
    let document = document(&case(0));
    let tables = tables(section(&document, "errors"));
    let [fitted, held_out] = tables[..] else { panic!("two tables") };
    assert!(fitted.caption.contains("fitted") && held_out.caption.contains("held-out"));
    assert!(fitted.rows.iter().all(|row| row[1].contains("bending")));
    assert!(held_out.rows.iter().all(|row| ["neutral", "traction"].contains(&row[1].as_str())));
}

#[test]
fn every_number_has_its_unit_in_the_heading() {
    for document in [document(&case(0)), cohort_document(&[])] {
        for table in document.sections.iter().flat_map(|section| tables(section)) {
            for column in &table.columns {
                let head = column.head.to_lowercase();
                for (word, unit) in [("error", "("), ("cobb", "(°)"), ("stiffness", "(")] {
                    if column.numeric && head.contains(word) {
                        assert!(head.contains(unit), "{}: {head}", table.caption);
                    }
                }
            }
        }
    }
}

/// Headings, captions, heads of columns and notes below tables: what the report itself calls things.
fn own_words(document: &Document) -> Vec<String> {
    let mut found = Vec::new();
    for section in &document.sections {
        found.push(section.title.clone());
        for block in &section.blocks {
            match block {
                Block::Heading(text) => found.push(text.clone()),
                Block::Figure(figure) => found.push(figure.caption.clone()),
                Block::Table(table) => {
                    found.extend([table.caption.clone(), table.note.clone()]);
                    found.extend(table.columns.iter().map(|column| column.head.clone()));
                }
                Block::Paragraph(_) | Block::Notice(_) => {}
            }
        }
    }
    found
}

#[test]
fn reports_use_the_terms_of_the_field() {
    const AVOIDED: [&str; 12] = [
        "mark",
        "marks",
        "lean",
        "leans",
        "leaning",
        "prefer",
        "preferred",
        "told",
        "truth",
        "lacking",
        "growing",
        "gauge",
    ];
    let case = case(0);
    let documents = [document(&case), cohort_document(&[])];
    let found: Vec<String> = documents.iter().flat_map(own_words).collect();
    for text in &found {
        let words = text.split(|c: char| !c.is_alphanumeric()).map(str::to_lowercase);
        for word in words {
            assert!(!AVOIDED.contains(&word.as_str()), "`{word}` in `{text}`");
        }
    }
    for term in [
        "Lateral tilt of L4–T2 against the iliac normal",
        "Line of best fit to the rotations of each film",
        "Counter-rotating joints",
        "Films with landmarks",
    ] {
        assert!(found.iter().any(|text| text.contains(term)), "{term}");
    }
    let text = markdown(&documents[0], "figures");
    assert!(text.contains("Scale constraint (gauge)"), "{text}");
}

#[test]
fn a_film_without_a_result_has_no_number_of_counter_rotating_joints() {
    let case = case(0);
    let mut analysis = analyzed(&case);
    let bend = analysis.models[0].simulations.iter_mut().find(|one| one.fitted);
    bend.expect("a fitted bend").status = PathEnding::Unreachable;
    let document = patient::report(&shown(&case, &analysis, JSON));
    let blocks = document.sections.iter().flat_map(|section| &section.blocks);
    let mut tables = blocks.filter_map(|block| match block {
        Block::Table(table) => Some(table),
        _ => None,
    });
    let table = tables.find(|table| table.caption == "Errors on fitted films").expect("a table");
    let lost: Vec<_> = table.rows.iter().filter(|row| row[2] == "unreachable").collect();
    assert_eq!(lost.len(), 1);
    assert_eq!(lost[0].last().map(String::as_str), Some("–"));
}

#[test]
fn a_report_of_an_erect_film_alone_names_what_is_missing() {
    let mut alone = case(0);
    alone.films.retain(|film| film.posture == spineline::anatomy::Posture::Erect);
    let document = document(&alone);
    assert!(document.sections.iter().all(|section| !section.blocks.is_empty()));
    let text = html(&document);
    assert!(text.contains("The patient has no personalised model"));
}

#[test]
fn user_text_is_escaped_in_html() {
    for name in HOSTILE {
        let text = html(&document(&named(name)));
        // The two scripts of the report, one of data and one for the view in space.
        assert_eq!(text.matches("<script").count(), 3, "{name}");
        assert_eq!(text.matches("</script>").count(), 3, "{name}");
        let shown = name.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let shown = shown.replace('"', "&quot;");
        assert!(text.contains(&format!("<bdi>{shown}</bdi>")), "{name}");
        assert!(!text.contains("http://") || text.contains("http://www.w3.org/2000/svg"));
    }
}

#[test]
fn user_text_is_escaped_in_markdown() {
    for name in HOSTILE {
        let text = markdown(&document(&named(name)), "figures");
        let (report, _) = text.split_once("## Analysis as JSON").expect("the appendix");
        assert!(!report.contains("<script") && !report.contains("```"), "{name}");
        let title = report.lines().next().expect("a title");
        assert!(title.starts_with("# Patient report: "), "{title}");
        for active in ["*b*", "`c`", "$d$", "[e]", "_x_", " | "] {
            assert!(!title.contains(active), "{title}");
        }
    }
}

#[test]
fn markdown_tables_keep_their_columns() {
    let refused = [RefusedCase {
        file: "a|b|c.json".to_owned(),
        case_id: None,
        step: RefusalStep::Reading,
        reason: "line 1\n| 2".to_owned(),
    }];
    let document = cohort_document(&refused);
    let text = markdown(&document, "figures");
    let mut columns = None;
    for line in text.lines() {
        if !line.starts_with('|') {
            columns = None;
            continue;
        }
        let bars = line.replace("\\|", "").matches('|').count();
        assert_eq!(*columns.get_or_insert(bars), bars, "{line}");
    }
    assert!(text.contains("a\\|b\\|c.json"));
}

#[test]
fn the_embedded_analysis_round_trips() {
    let document = document(&named(HOSTILE[0]));
    assert_eq!(embedded(html(&document).as_bytes()).as_deref(), Some(JSON));
    assert_eq!(embedded(markdown(&document, "f").as_bytes()).as_deref(), Some(JSON));
    assert_eq!(embedded(b"# A report of another program"), None);
    assert_eq!(embedded(&[0xff, 0xfe]), None);
}

#[test]
fn equal_input_gives_equal_bytes() {
    let (first, second) = (document(&case(1)), document(&case(1)));
    assert_eq!(html(&first), html(&second));
    assert_eq!(markdown(&first, "f"), markdown(&second, "f"));
    let svg = |document: &Document| document.figures().next().expect("a figure").svg.clone();
    let pixels = |document: &Document| png(&svg(document), 1.0).expect("an SVG");
    assert_eq!(pixels(&first), pixels(&second));
}

#[test]
fn a_cohort_report_has_every_section_and_counts_excluded_patients() {
    let refused = [("bad.json", RefusalStep::Reading), ("odd.json", RefusalStep::Analysis)].map(
        |(file, step)| RefusedCase {
            file: file.to_owned(),
            case_id: None,
            step,
            reason: "reasons".to_owned(),
        },
    );
    let document = cohort_document(&refused);
    let ids: Vec<&str> = document.sections.iter().map(|section| section.id).collect();
    assert_eq!(
        ids,
        [
            "short",
            "verdict",
            "flow",
            "patients",
            "lenke",
            "movement",
            "errors",
            "tests",
            "by-patient",
            "reliability",
            "method"
        ]
    );
    let flow = &document.figures().next().expect("the flow").svg;
    for words in [">5<", ">3<", "case files read", "1 not: the file could not be read", "analysed"]
    {
        assert!(flow.contains(words), "{words}");
    }
    let figures = figure_names(&document);
    assert!(figures.contains(&"errors-fitted") && figures.contains(&"errors-held-out"));
    let tested = tables(section(&document, "tests"));
    assert!(tested[0].rows[0][1].contains("all treated as independent"));
    assert!(tested[0].rows[0][2].contains("patients"));
    assert!(!tables(section(&document, "reliability"))[0].rows.is_empty());
}

#[test]
fn figures_are_converted_to_png() {
    for figure in document(&case(0)).figures() {
        let pixels = png(&figure.svg, 0.5).expect("it is an SVG");
        assert!(pixels.starts_with(b"\x89PNG"), "{}", figure.name);
        assert!(pixels.len() > 4000, "{} has hardly anything on it", figure.name);
    }
    assert!(png("<p>no picture</p>", 1.0).is_err());
}
