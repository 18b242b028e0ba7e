use std::collections::BTreeMap;

use dicom_core::VR;
use dicom_dictionary_std::{tags, uids};
use dicom_object::{FileMetaTableBuilder, InMemDicomObject};
use spineline::anatomy::Level;
use spineline::clinical::convex_side;
use spineline::measure::{CornerName, Corners, EndplateTilts, VertebraLandmarks};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline_films::{is_uid, uid_of_bytes};

use super::ReportOf;
use super::codes::{self, Code};
use super::item::{
    Relation, code, container, image, number, person, points, reference, root, sequence, text,
    text_element, uid_reference,
};
use crate::LandmarkExportError;
use crate::film::{HALF_PIXEL, stated_origins};

const MODEL: &str = concat!("spineline ", env!("CARGO_PKG_VERSION"));

/// The bytes of a DICOM file with the report of one reading. The same reading gives the same bytes, identifiers included.
///
/// # Errors
/// [`LandmarkExportError`] for an observer or a corner that a report cannot hold, and for a radiograph of another size or
/// without identifiers.
pub fn write_sr(report: &ReportOf<'_>) -> Result<Vec<u8>, LandmarkExportError> {
    check(report)?;
    let content = content(report)?;
    let mut document = modules(report);
    root(&mut document, codes::REPORT, "1500", content);
    let encode = |error: &dyn std::fmt::Display| LandmarkExportError::Encode(error.to_string());
    // The identifier of the report is derived from its content.
    let syntax = dicom_transfer_syntax_registry::entries::EXPLICIT_VR_LITTLE_ENDIAN.erased();
    let mut said = Vec::new();
    document.write_dataset_with_ts(&mut said, &syntax).map_err(|error| encode(&error))?;
    let instance = uid(&[b"report", &said]);
    document.put(text_element(tags::SOP_INSTANCE_UID, VR::UI, &instance));
    let meta = FileMetaTableBuilder::new()
        .transfer_syntax(uids::EXPLICIT_VR_LITTLE_ENDIAN)
        .media_storage_sop_class_uid(uids::COMPREHENSIVE_SR_STORAGE)
        .media_storage_sop_instance_uid(instance);
    let file = document.with_meta(meta).map_err(|error| encode(&error))?;
    let mut bytes = Vec::new();
    file.write_all(&mut bytes).map_err(|error| encode(&error))?;
    Ok(bytes)
}

/// An identifier below the arc of UUIDs (2.25), from the identified parts.
fn uid(parts: &[&[u8]]) -> String {
    let with_length = |part: &&[u8]| [&(part.len() as u64).to_le_bytes()[..], *part].concat();
    uid_of_bytes(&parts.iter().flat_map(with_length).collect::<Vec<u8>>())
}

fn check(report: &ReportOf<'_>) -> Result<(), LandmarkExportError> {
    let source = report.source;
    let unfit = |reason: String| {
        Err(LandmarkExportError::Source(format!("{} film: {reason}", report.posture)))
    };
    for (what, uid) in [
        ("SOP Class UID", &source.sop_class_uid),
        ("SOP Instance UID", &source.sop_instance_uid),
        ("Study Instance UID", &source.study_instance_uid),
        ("Series Instance UID", &source.series_instance_uid),
    ] {
        if !is_uid(uid) {
            return unfit(format!("its DICOM file has no valid {what}"));
        }
    }
    let size = (report.image.columns, report.image.rows);
    if source.size != size {
        return unfit(format!(
            "the picture of the case has {} × {} pixels, but its DICOM file has {} × {}",
            size.0, size.1, source.size.0, source.size.1
        ));
    }
    let [date, time] = report.written;
    let digits =
        |text: &str, count| text.len() == count && text.bytes().all(|b| b.is_ascii_digit());
    if !(digits(date, 8) && digits(time, 6)) {
        return unfit("the date or time of the report is not written as in DICOM".to_owned());
    }
    let name = &report.reading.id.observer;
    // A person's name has its own separators, and a value of DICOM has a backslash.
    if name.trim() != name || name.is_empty() || name.chars().count() > 64 {
        let reason = "a code of at most 64 characters without blanks around it is needed";
        return Err(LandmarkExportError::Observer { name: name.clone(), reason });
    }
    if name.chars().any(|c| c.is_control() || matches!(c, '\\' | '^' | '=')) {
        let reason =
            "a report cannot contain control characters, backslashes, carets and equals signs";
        return Err(LandmarkExportError::Observer {
            name: name.escape_default().to_string(),
            reason,
        });
    }
    Ok(())
}

/// Everything but the content: patient, study, series, equipment and document.
fn modules(report: &ReportOf<'_>) -> InMemDicomObject {
    let source = report.source;
    let [date, time] = report.written;
    let study = source.study_instance_uid.as_bytes();
    let series = uid(&[b"series", study]);
    let mut document = InMemDicomObject::new_empty();
    let mut put = |tag, vr, value: &str| {
        document.put(text_element(tag, vr, value));
    };
    put(tags::SPECIFIC_CHARACTER_SET, VR::CS, "ISO_IR 192");
    put(tags::SOP_CLASS_UID, VR::UI, uids::COMPREHENSIVE_SR_STORAGE);
    put(tags::TIMEZONE_OFFSET_FROM_UTC, VR::SH, "+0000");
    put(tags::PATIENT_NAME, VR::PN, &source.patient_name);
    put(tags::PATIENT_ID, VR::LO, &source.patient_id);
    put(tags::PATIENT_BIRTH_DATE, VR::DA, &source.patient_birth_date);
    put(tags::PATIENT_SEX, VR::CS, &source.patient_sex);
    put(tags::STUDY_INSTANCE_UID, VR::UI, &source.study_instance_uid);
    put(tags::STUDY_DATE, VR::DA, &source.study_date);
    put(tags::STUDY_TIME, VR::TM, &source.study_time);
    put(tags::STUDY_ID, VR::SH, &source.study_id);
    put(tags::ACCESSION_NUMBER, VR::SH, &source.accession_number);
    put(tags::REFERRING_PHYSICIAN_NAME, VR::PN, "");
    put(tags::MODALITY, VR::CS, "SR");
    put(tags::SERIES_INSTANCE_UID, VR::UI, &series);
    put(tags::SERIES_NUMBER, VR::IS, "1");
    put(tags::SERIES_DESCRIPTION, VR::LO, "Spineline: landmarks, research use only");
    put(tags::MANUFACTURER, VR::LO, codes::SCHEME_NAME);
    put(tags::MANUFACTURER_MODEL_NAME, VR::LO, MODEL);
    put(tags::INSTANCE_NUMBER, VR::IS, "1");
    put(tags::COMPLETION_FLAG, VR::CS, "COMPLETE");
    put(tags::VERIFICATION_FLAG, VR::CS, "UNVERIFIED");
    put(tags::CONTENT_DATE, VR::DA, date);
    put(tags::CONTENT_TIME, VR::TM, time);
    document.put(sequence(tags::REFERENCED_PERFORMED_PROCEDURE_STEP_SEQUENCE, vec![]));
    document.put(sequence(tags::PERFORMED_PROCEDURE_CODE_SEQUENCE, vec![]));
    let scheme = InMemDicomObject::from_element_iter([
        text_element(tags::CODING_SCHEME_DESIGNATOR, VR::SH, codes::SCHEME),
        text_element(tags::CODING_SCHEME_NAME, VR::ST, codes::SCHEME_NAME),
    ]);
    document.put(sequence(tags::CODING_SCHEME_IDENTIFICATION_SEQUENCE, vec![scheme]));
    let of_series = InMemDicomObject::from_element_iter([
        text_element(tags::SERIES_INSTANCE_UID, VR::UI, &source.series_instance_uid),
        sequence(tags::REFERENCED_SOP_SEQUENCE, vec![reference(source)]),
    ]);
    let of_study = InMemDicomObject::from_element_iter([
        text_element(tags::STUDY_INSTANCE_UID, VR::UI, &source.study_instance_uid),
        sequence(tags::REFERENCED_SERIES_SEQUENCE, vec![of_series]),
    ]);
    document.put(sequence(tags::CURRENT_REQUESTED_PROCEDURE_EVIDENCE_SEQUENCE, vec![of_study]));
    document
}

fn content(report: &ReportOf<'_>) -> Result<Vec<InMemDicomObject>, LandmarkExportError> {
    use Relation::{AcquisitionContext, Contains, Modifier, ObservationContext};
    let source = report.source;
    let mut groups = Vec::new();
    let mut endplates = BTreeMap::new();
    for (&level, landmark) in &report.reading.vertebrae {
        let (tilts, group) = vertebra(report, level, landmark)?;
        endplates.insert(level, tilts);
        groups.push(group);
    }
    groups.extend(iliac_line(report)?);
    for (region, ends) in report.curves {
        let ends_of = (endplates.get(&ends.inferior), endplates.get(&ends.superior));
        if let (Some(lower), Some(upper)) = ends_of {
            groups.push(curve(
                report,
                codes::region(*region),
                [ends.superior, ends.inferior],
                (upper.superior - lower.inferior).wrapped(),
            )?);
        }
    }
    let modality = codes::modality(&source.modality)
        .map(|value| code(AcquisitionContext, codes::MODALITY, value));
    let library = image(Contains, source, modality.into_iter().collect());
    Ok(vec![
        code(Modifier, codes::LANGUAGE, codes::ENGLISH),
        code(ObservationContext, codes::OBSERVER_TYPE, codes::PERSON),
        // A name of one component is marked by a caret.
        person(ObservationContext, codes::PERSON_NAME, &format!("{}^", report.reading.id.observer)),
        code(ObservationContext, codes::OBSERVER_TYPE, codes::DEVICE),
        uid_reference(ObservationContext, codes::DEVICE_UID, &uid(&[b"device", MODEL.as_bytes()])),
        text(ObservationContext, codes::DEVICE_NAME, codes::SCHEME_NAME),
        text(ObservationContext, codes::DEVICE_MODEL, MODEL),
        code(Modifier, codes::PROCEDURE, codes::RADIOGRAPHY),
        container(
            Contains,
            codes::LIBRARY,
            None,
            vec![container(Contains, codes::LIBRARY_GROUP, None, vec![library])],
        ),
        container(Contains, codes::MEASUREMENTS, None, groups),
    ])
}

/// A measurement group with its common items.
fn group(
    report: &ReportOf<'_>,
    what: &str,
    finding: Code,
    sites: &[Code],
    rest: Vec<InMemDicomObject>,
) -> InMemDicomObject {
    let id = &report.reading.id;
    let posture = codes::posture(report.posture);
    let tracking = format!("{} {what}", report.posture.key());
    let identifier = uid(&[
        b"tracking",
        report.source.sop_instance_uid.as_bytes(),
        id.observer.as_bytes(),
        &id.repeat.to_le_bytes(),
        tracking.as_bytes(),
    ]);
    let mut content = vec![
        text(Relation::ObservationContext, codes::TRACKING, &tracking),
        uid_reference(Relation::ObservationContext, codes::TRACKING_UID, &identifier),
        text(Relation::ObservationContext, codes::SESSION, &id.repeat.to_string()),
        code(Relation::Contains, codes::FINDING, finding),
    ];
    content.extend(sites.iter().map(|&site| code(Relation::Modifier, codes::SITE, site)));
    content.extend(rest);
    content.push(code(Relation::Contains, codes::POSTURE, posture));
    container(Relation::Contains, codes::GROUP, Some("1501"), content)
}

fn vertebra(
    report: &ReportOf<'_>,
    level: Level,
    landmark: &VertebraLandmarks,
) -> Result<(EndplateTilts, InMemDicomObject), LandmarkExportError> {
    let image = report.image;
    let unfit = || corner_of(report, level);
    let places = places(report, level, &landmark.corners.points())?;
    let body: Corners<Frontal> = landmark.corners.map(|corner| image.frontal(corner));
    let location = image.pixel(body.measure_location().map_err(|_| unfit())?);
    let (tilt, method) = match landmark.axis_clockwise {
        Some(axis) => (image.tilt_from_clockwise(axis), codes::BY_HAND),
        None => (body.measure_endplate_tilt(), codes::BY_ENDPLATES),
    };
    let from = || points(codes::SOURCE, &places, report.source);
    let mut measured = vec![
        number(
            codes::TILT,
            tilt.deg(),
            codes::DEGREE,
            vec![code(Relation::Modifier, codes::METHOD, method), from()],
        ),
        number(codes::COLUMN, location.column_px + HALF_PIXEL, codes::PIXEL, vec![from()]),
        number(codes::ROW, location.row_px + HALF_PIXEL, codes::PIXEL, vec![from()]),
    ];
    // The axis as set, so that reading does not need the sides of the picture.
    let axis =
        landmark.axis_clockwise.map(|axis| number(codes::AXIS, axis.deg(), codes::DEGREE, vec![]));
    measured.extend(axis);
    let origins = CornerName::ALL.into_iter().zip(stated_origins(landmark).into_iter().flatten());
    measured.extend(origins.map(|(corner, origin)| {
        code(Relation::Contains, codes::origin_of(corner), codes::origin(origin))
    }));
    let sites = [codes::vertebra(level)];
    let endplates = body.measure_endplates();
    Ok((endplates, group(report, level.name(), codes::VERTEBRA, &sites, measured)))
}

fn iliac_line(report: &ReportOf<'_>) -> Result<Option<InMemDicomObject>, LandmarkExportError> {
    let Some(crests) = report.iliac_crests else { return Ok(None) };
    let outside = |_| LandmarkExportError::Crests(report.posture);
    let places = places(report, Level::L5, &[crests.left, crests.right]).map_err(outside)?;
    let to_left = report.image.frontal(crests.left) - report.image.frontal(crests.right);
    let normal = Frontal::new(-to_left.z_mm, to_left.y_mm).lateral_tilt();
    let from = points(codes::SOURCE, &places, report.source);
    let measured = vec![number(codes::ILIAC_TILT, normal.deg(), codes::DEGREE, vec![from])];
    let sites = [codes::ILIAC_CREST];
    Ok(Some(group(report, "iliac line", codes::ILIAC_LINE, &sites, measured)))
}

fn curve(
    report: &ReportOf<'_>,
    region: Code,
    ends: [Level; 2],
    cobb: Angle,
) -> Result<InMemDicomObject, LandmarkExportError> {
    let mut from = Vec::new();
    for level in ends {
        let corners = report.reading.vertebrae[&level].corners.points();
        from.push(points(codes::SOURCE, &places(report, level, &corners)?, report.source));
    }
    let mut measured = vec![number(codes::COBB, cobb.abs().deg(), codes::DEGREE, from)];
    let convex = convex_side(cobb).map(codes::side);
    measured.extend(convex.map(|side| code(Relation::Contains, codes::CONVEXITY, side)));
    let Code(name, ..) = region;
    Ok(group(report, name, region, &ends.map(codes::vertebra), measured))
}

/// Column and row of each point as spatial coordinates.
fn places(
    report: &ReportOf<'_>,
    level: Level,
    points: &[Pixel],
) -> Result<Vec<f32>, LandmarkExportError> {
    if !points.iter().all(|&point| report.image.contains(point)) {
        return Err(corner_of(report, level));
    }
    let pairs = points.iter().flat_map(|point| [point.column_px, point.row_px]);
    Ok(pairs.map(|value| (value + HALF_PIXEL) as f32).collect())
}

fn corner_of(report: &ReportOf<'_>, level: Level) -> LandmarkExportError {
    let what = format!("{} film, observer {}", report.posture, report.reading.id);
    LandmarkExportError::Corner { what, level }
}
