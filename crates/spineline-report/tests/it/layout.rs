//! Films fill their page, and tables keep their heads on paper.

use spineline::anatomy::Posture;
use spineline_report::document::{Column, Section, Table};
use spineline_report::figures::FlowStep;
use spineline_report::{Document, figures, html};

use crate::common::{GENERATOR, analyzed, exact_rod, report, rod_with_films};

/// Between the edges of a figure, for frames and written axes.
const PAGE_PX: f64 = 900.0;

/// Width and height of every frame of a figure, from the rectangles that clip its contents.
fn frames_px(svg: &str) -> Vec<[f64; 2]> {
    let number = |text: &str, name: &str| {
        let (_, tail) = text.split_once(&format!(" {name}=\""))?;
        tail.split_once('"')?.0.parse::<f64>().ok()
    };
    let clips = svg.split("<clipPath").skip(1);
    clips.filter_map(|clip| Some([number(clip, "width")?, number(clip, "height")?])).collect()
}

#[test]
fn films_fill_the_page_whatever_their_number() {
    for (count, per_row) in [(2, 2), (3, 3), (4, 2), (5, 3)] {
        let case = rod_with_films(1, &Posture::ALL[..count]);
        let analysis = analyzed(&case);
        let frames = frames_px(&figures::films(&case, &analysis, &[]));
        assert_eq!(frames.len(), count);
        let row: f64 = frames[..per_row].iter().map(|[width, _]| width).sum();
        assert!(row > 0.8 * PAGE_PX, "{count} films: {row} px of {PAGE_PX}");
        let [width, height] = frames[0];
        // A radiograph is about 0.6 to 0.9 times as wide as high.
        assert!((0.55..0.95).contains(&(width / height)), "{count} films: {width} x {height} px");
        for frame in &frames {
            let same = frame.iter().zip(frames[0]).all(|(a, b)| (a - b).abs() < 0.1);
            assert!(same, "{count} films: {frames:?}");
        }
    }
}

#[test]
fn predicted_films_fill_the_row() {
    let svg = figures::predictions(&analyzed(&exact_rod(1))).expect("bends");
    let frames = frames_px(&svg);
    let row: f64 = frames.iter().map(|[width, _]| width).sum();
    assert!(frames.len() == 2 && row > 0.8 * PAGE_PX, "{frames:?}");
    // Both sides of both films have a number.
    for side in [" L<", " R<"] {
        assert!(svg.matches(side).count() >= 2, "{side}: {svg}");
    }
}

#[test]
fn the_flow_of_cases_is_as_wide_as_its_reasons() {
    let step = |lost: &[(&str, usize)]| FlowStep {
        name: "analysed".to_owned(),
        cases: 3,
        lost: lost.iter().map(|&(why, n)| (why.to_owned(), n)).collect(),
    };
    let width_px = |svg: &str| -> f64 {
        let tail = svg.split_once(" viewBox=\"0 0 ").expect("a size").1;
        tail.split(' ').next().and_then(|word| word.parse().ok()).expect("a width")
    };
    let bare = width_px(&figures::exclusions(&[step(&[]), step(&[])], false));
    let why = [("no line of action on any bend, and a long reason beside it", 1)];
    let wide = width_px(&figures::exclusions(&[step(&why), step(&[])], false));
    // A box has 300 px, and a line of a reason at most 430 px.
    assert!((600.0..700.0).contains(&bare), "{bare}");
    assert!((700.0..PAGE_PX).contains(&wide), "{wide}");
}

#[test]
fn films_may_fill_a_page() {
    let case = exact_rod(1);
    let document = report(&case);
    let whole: Vec<&str> =
        document.figures().filter(|f| f.whole_page).map(|f| f.name.as_str()).collect();
    assert_eq!(whole, ["films"]);
    assert!(html(&document).contains("class=\"picture whole-page\""));
}

fn table(rows: usize, columns: usize) -> Table {
    let names = (0..columns).map(|i| Column::words(format!("column {i}")));
    let mut table = Table::new(format!("{rows} rows"), names.collect());
    for row in 0..rows {
        table.row((0..columns).map(|column| format!("{row}.{column}")).collect());
    }
    table
}

#[test]
fn printed_tables_keep_their_heads() {
    let mut section = Section::new("tables", "Tables");
    section.table(table(5, 3));
    section.table(table(200, 12));
    let document = Document {
        analysis: "{}".to_owned(),
        ..Document::new("Report", "P07", GENERATOR, vec![section])
    };
    let text = html(&document);
    let (style, body) = text.split_once("</style>").expect("a style");
    let (_, print) = style.split_once("@media print").expect("rules for paper");
    // A short table is kept whole; a long one is not, but repeats its head and divides no row.
    assert!(body.contains("class=\"table short\""), "{body}");
    assert!(body.contains("class=\"table many-columns\""), "{body}");
    let rules = |selector: &str| {
        let lines = print.lines().filter(|line| {
            let (selectors, _) = line.split_once('{').unwrap_or((line, ""));
            selectors.split(',').any(|one| one.trim() == selector)
        });
        lines.collect::<Vec<_>>().join(" ")
    };
    assert!(rules("figure.table.short").contains("break-inside: avoid"), "{print}");
    assert!(!rules("figure").contains("break-inside"), "{print}");
    assert!(rules("tr").contains("break-inside: avoid"), "{print}");
    assert!(rules("thead").contains("display: table-header-group"), "{print}");
    assert!(rules("figure.table figcaption").contains("break-after: avoid"), "{print}");
    // Nothing is cut off or scrolled on paper.
    assert!(rules(".wide").contains("overflow: visible"), "{print}");
    // Chromium prints the words of a head that is repeated only where no control holds them.
    let (_, script) = body.split_once("ariaLabel").expect("the control that sorts");
    assert!(!script.contains("head.childNodes"));
}
