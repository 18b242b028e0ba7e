//! Content items of a report.

use dicom_core::value::PrimitiveValue;
use dicom_core::{DataElement, Tag, VR};
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use dicom_object::mem::InMemElement;

use super::SourceImage;
use super::codes::Code;

/// Relation of an item to its parent.
#[derive(Debug, Clone, Copy)]
pub enum Relation {
    Contains,
    ObservationContext,
    AcquisitionContext,
    Modifier,
    InferredFrom,
    SelectedFrom,
}

impl Relation {
    const fn key(self) -> &'static str {
        match self {
            Self::Contains => "CONTAINS",
            Self::ObservationContext => "HAS OBS CONTEXT",
            Self::AcquisitionContext => "HAS ACQ CONTEXT",
            Self::Modifier => "HAS CONCEPT MOD",
            Self::InferredFrom => "INFERRED FROM",
            Self::SelectedFrom => "SELECTED FROM",
        }
    }
}

pub fn text_element(tag: Tag, vr: VR, value: &str) -> InMemElement {
    DataElement::new(tag, vr, PrimitiveValue::from(value))
}

pub fn sequence(tag: Tag, items: Vec<InMemDicomObject>) -> InMemElement {
    DataElement::new(tag, VR::SQ, dicom_core::value::DataSetSequence::from(items))
}

fn coded(tag: Tag, Code(value, scheme, meaning): Code) -> InMemElement {
    let code = InMemDicomObject::from_element_iter([
        text_element(tags::CODE_VALUE, VR::SH, value),
        text_element(tags::CODING_SCHEME_DESIGNATOR, VR::SH, scheme),
        text_element(tags::CODE_MEANING, VR::LO, meaning),
    ]);
    sequence(tag, vec![code])
}

fn item(relation: Relation, kind: &str, name: Option<Code>) -> InMemDicomObject {
    let mut item = InMemDicomObject::new_empty();
    item.put(text_element(tags::RELATIONSHIP_TYPE, VR::CS, relation.key()));
    item.put(text_element(tags::VALUE_TYPE, VR::CS, kind));
    if let Some(name) = name {
        item.put(coded(tags::CONCEPT_NAME_CODE_SEQUENCE, name));
    }
    item
}

pub fn code(relation: Relation, name: Code, value: Code) -> InMemDicomObject {
    let mut item = item(relation, "CODE", Some(name));
    item.put(coded(tags::CONCEPT_CODE_SEQUENCE, value));
    item
}

pub fn text(relation: Relation, name: Code, value: &str) -> InMemDicomObject {
    let mut item = item(relation, "TEXT", Some(name));
    item.put(text_element(tags::TEXT_VALUE, VR::UT, value));
    item
}

pub fn person(relation: Relation, name: Code, value: &str) -> InMemDicomObject {
    let mut item = item(relation, "PNAME", Some(name));
    item.put(text_element(tags::PERSON_NAME, VR::PN, value));
    item
}

pub fn uid_reference(relation: Relation, name: Code, value: &str) -> InMemDicomObject {
    let mut item = item(relation, "UIDREF", Some(name));
    item.put(text_element(tags::UID, VR::UI, value));
    item
}

pub fn container(
    relation: Relation,
    name: Code,
    template: Option<&str>,
    content: Vec<InMemDicomObject>,
) -> InMemDicomObject {
    let mut item = item(relation, "CONTAINER", Some(name));
    fill_container(&mut item, template, content);
    item
}

/// The root of a document, whose elements lie in the data set itself.
pub fn root(
    document: &mut InMemDicomObject,
    name: Code,
    template: &str,
    content: Vec<InMemDicomObject>,
) {
    document.put(text_element(tags::VALUE_TYPE, VR::CS, "CONTAINER"));
    document.put(coded(tags::CONCEPT_NAME_CODE_SEQUENCE, name));
    fill_container(document, Some(template), content);
}

fn fill_container(
    item: &mut InMemDicomObject,
    template: Option<&str>,
    content: Vec<InMemDicomObject>,
) {
    item.put(text_element(tags::CONTINUITY_OF_CONTENT, VR::CS, "SEPARATE"));
    if let Some(template) = template {
        let identified = InMemDicomObject::from_element_iter([
            text_element(tags::MAPPING_RESOURCE, VR::CS, "DCMR"),
            text_element(tags::TEMPLATE_IDENTIFIER, VR::CS, template),
        ]);
        item.put(sequence(tags::CONTENT_TEMPLATE_SEQUENCE, vec![identified]));
    }
    item.put(sequence(tags::CONTENT_SEQUENCE, content));
}

/// A number with its unit and its sources.
pub fn number(
    name: Code,
    value: f64,
    unit: Code,
    content: Vec<InMemDicomObject>,
) -> InMemDicomObject {
    let mut item = item(Relation::Contains, "NUM", Some(name));
    let mut measured = InMemDicomObject::new_empty();
    // A decimal string holds 16 characters; the floating value holds all digits.
    measured.put(text_element(tags::NUMERIC_VALUE, VR::DS, &format!("{value:.6}")));
    measured.put(DataElement::new(tags::FLOATING_POINT_VALUE, VR::FD, PrimitiveValue::from(value)));
    measured.put(coded(tags::MEASUREMENT_UNITS_CODE_SEQUENCE, unit));
    item.put(sequence(tags::MEASURED_VALUE_SEQUENCE, vec![measured]));
    if !content.is_empty() {
        item.put(sequence(tags::CONTENT_SEQUENCE, content));
    }
    item
}

/// Places on a radiograph from which a value was derived.
pub fn points(name: Code, places: &[f32], source: &SourceImage) -> InMemDicomObject {
    let mut item = item(Relation::InferredFrom, "SCOORD", Some(name));
    item.put(text_element(tags::GRAPHIC_TYPE, VR::CS, "MULTIPOINT"));
    let data = PrimitiveValue::F32(places.iter().copied().collect());
    item.put(DataElement::new(tags::GRAPHIC_DATA, VR::FL, data));
    item.put(sequence(tags::CONTENT_SEQUENCE, vec![image(Relation::SelectedFrom, source, vec![])]));
    item
}

/// A reference to a radiograph.
pub fn image(
    relation: Relation,
    source: &SourceImage,
    content: Vec<InMemDicomObject>,
) -> InMemDicomObject {
    let mut item = item(relation, "IMAGE", None);
    item.put(sequence(tags::REFERENCED_SOP_SEQUENCE, vec![reference(source)]));
    if !content.is_empty() {
        item.put(sequence(tags::CONTENT_SEQUENCE, content));
    }
    item
}

pub fn reference(source: &SourceImage) -> InMemDicomObject {
    InMemDicomObject::from_element_iter([
        text_element(tags::REFERENCED_SOP_CLASS_UID, VR::UI, &source.sop_class_uid),
        text_element(tags::REFERENCED_SOP_INSTANCE_UID, VR::UI, &source.sop_instance_uid),
    ])
}
