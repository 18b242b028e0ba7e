//! Vertebral bodies as VTK's XML PolyData.

use spineline::analysis::{AxialSource, PersonalisedModel, PitchSource};
use spineline::spatial::Vec3;

use super::assembly::Vertebra;
use super::boxes::{SIDES, corners};
use super::header::{about_bodies, mark};
use super::standing::{flag, key};
use super::xml::{Document, numbers};

/// Format and frame.
const DESCRIBED: [&str; 2] = [
    "VTK PolyData",
    "LPS in mm, as in 3D Slicer's files: x to the patient's left, y posterior, z cranial. It is Spineline's y, −x, z.",
];

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, vertebrae: &[Vertebra], generator: &str) -> String {
    let count = |number: usize| number.to_string();
    let mut xml = Document::new();
    let mut about = about_bodies(model, generator, DESCRIBED);
    about.push(mark(model));
    xml.comment(&about.join("\n  "));
    let file = [
        ("type", "PolyData"),
        ("version", "1.0"),
        ("byte_order", "LittleEndian"),
        ("header_type", "UInt64"),
    ];
    xml.open("VTKFile", &file);
    xml.open("PolyData", &[]);
    xml.open("FieldData", &[]);
    strings(&mut xml, "SPACE", &["LPS"]);
    let words = |of: fn(&Vertebra) -> &'static str| vertebrae.iter().map(of).collect::<Vec<_>>();
    strings(&mut xml, "level_names", &words(|v| v.name));
    strings(&mut xml, "pitch_from", &words(|v| key(v.pitch_from)));
    strings(&mut xml, "axial_rotation_from", &words(|v| key(v.axial_from)));
    xml.close();
    let points = count(vertebrae.len() * 8);
    let sides = count(vertebrae.len() * SIDES.len());
    let piece = [
        ("NumberOfPoints", &*points),
        ("NumberOfVerts", "0"),
        ("NumberOfLines", "0"),
        ("NumberOfStrips", "0"),
        ("NumberOfPolys", &*sides),
    ];
    xml.open("Piece", &piece);
    for (element, share) in [("PointData", 8), ("CellData", SIDES.len())] {
        xml.open(element, &[("Scalars", "axial_rotation_deg")]);
        values(&mut xml, vertebrae, share);
        xml.close();
    }
    surface(&mut xml, vertebrae);
    xml.finish()
}

/// Places of the corners, and the sides.
fn surface(xml: &mut Document, vertebrae: &[Vertebra]) {
    let mut places_mm = Vec::new();
    for body in vertebrae {
        for corner in corners() {
            let m = body.midpoint_m + body.axes * corner.component_mul(&body.size_m);
            let in_lps_m = Vec3::new(m.y, -m.x, m.z);
            places_mm.extend_from_slice((in_lps_m * 1000.0).as_slice());
        }
    }
    xml.open("Points", &[]);
    floats(xml, "Points", &places_mm, 3);
    xml.close();
    let around =
        (0..vertebrae.len()).flat_map(|i| SIDES.into_iter().flatten().map(move |c| 8 * i + c));
    let ends = (1..=vertebrae.len() * SIDES.len()).map(|side| 4 * side);
    xml.open("Polys", &[]);
    whole(xml, "connectivity", around);
    whole(xml, "offsets", ends);
    xml.close();
}

/// The numbers of every vertebra, each as often as it has points or sides.
fn values(xml: &mut Document, vertebrae: &[Vertebra], share: usize) {
    whole(xml, "level", (0..vertebrae.len()).flat_map(|i| std::iter::repeat_n(i, share)));
    let mut measured = |name: &str, of: &dyn Fn(&Vertebra) -> Option<bool>| {
        let each = vertebrae.iter().flat_map(|v| std::iter::repeat_n(flag(of(v)), share));
        array(xml, &[("type", "Int8"), ("Name", name)], &each.collect::<Vec<_>>().join(" "));
    };
    measured("pitch_measured", &|v| v.pitch_from.map(PitchSource::is_measured));
    measured("axial_rotation_measured", &|v| v.axial_from.map(AxialSource::is_measured));
    measured("width_measured", &|v| Some(v.width_is_measured));
    for (i, name) in ["lateral_tilt_deg", "pitch_deg", "axial_rotation_deg"].into_iter().enumerate()
    {
        let each = vertebrae.iter().flat_map(|v| std::iter::repeat_n(v.angles_deg()[i], share));
        floats(xml, name, &each.collect::<Vec<_>>(), 1);
    }
}

fn floats(xml: &mut Document, name: &str, values: &[f64], components: usize) {
    let components = components.to_string();
    array(
        xml,
        &[("type", "Float64"), ("Name", name), ("NumberOfComponents", &components)],
        &numbers(values),
    );
}

fn whole(xml: &mut Document, name: &str, values: impl Iterator<Item = usize>) {
    let texts: Vec<String> = values.map(|value| value.to_string()).collect();
    array(xml, &[("type", "Int64"), ("Name", name)], &texts.join(" "));
}

fn array(xml: &mut Document, attributes: &[(&str, &str)], text: &str) {
    xml.text_of("DataArray", &[attributes, &[("format", "ascii")]].concat(), text);
}

/// Texts as VTK writes them: the numbers of their bytes, each text closed by a zero.
fn strings(xml: &mut Document, name: &str, texts: &[&str]) {
    let count = texts.len().to_string();
    let bytes = texts.iter().flat_map(|text| text.bytes().chain([0]));
    let bytes: Vec<String> = bytes.map(|byte| byte.to_string()).collect();
    let attributes =
        [("type", "String"), ("Name", name), ("NumberOfTuples", &*count), ("format", "ascii")];
    xml.text_of("Array", &attributes, &bytes.join(" "));
}
