//! DICOM reports of landmarks: Comprehensive SR after the template TID 1500 (Measurement Report), one per reading.
//!
//! A report holds one measurement group (TID 1501) per vertebra with its site, its tilt and its location, inferred from
//! the four corners on the radiograph, with the origin of each corner unless a person clicked all; one for the iliac
//! line; and one per curve with its Cobb angle. The observer is the case's code of a reader, so a report is as
//! anonymous as its radiograph.
//!
//! Coordinates count from the *corner* of the first pixel in DICOM, and from its centre here, so half a pixel is added
//! and subtracted. They are single-precision numbers, which keep 1e-4 of a pixel.
//!
//! # References
//! DICOM PS3.3, C.18.6 (spatial coordinates); PS3.16, TID 300, 320, 1001, 1500, 1501, 1600; CID 7603 (vertebrae), CID 7550
//! (Cobb angle). Codes of 99SPINELINE belong to this program.

mod codes;
mod item;
mod read;
mod source;
mod write;

pub use read::read_sr;
pub use source::{parse_film_source, parse_source, read_film_source, read_source};
pub use write::write_sr;

use spineline::anatomy::{Posture, Region};
use spineline::clinical::CobbEnds;
use spineline::measure::{IliacCrests, ImageGeometry, Reading, VertebraLandmarks};

/// Data that a report copies from its radiograph.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SourceImage {
    /// SOP Class UID.
    pub sop_class_uid: String,
    /// SOP Instance UID.
    pub sop_instance_uid: String,
    /// Study Instance UID.
    pub study_instance_uid: String,
    /// Series Instance UID.
    pub series_instance_uid: String,
    /// Modality, such as `DX`.
    pub modality: String,
    /// Columns and rows.
    pub size: (u32, u32),
    /// Patient's Name, unchanged.
    pub patient_name: String,
    /// Patient ID.
    pub patient_id: String,
    /// Patient's Birth Date.
    pub patient_birth_date: String,
    /// Patient's Sex.
    pub patient_sex: String,
    /// Study Date.
    pub study_date: String,
    /// Study Time.
    pub study_time: String,
    /// Study ID.
    pub study_id: String,
    /// Accession Number.
    pub accession_number: String,
}

/// Input of a report.
#[derive(Debug, Clone, Copy)]
pub struct ReportOf<'a> {
    /// Posture.
    pub posture: Posture,
    /// The picture.
    pub image: &'a ImageGeometry,
    /// Tips of the iliac crests.
    pub iliac_crests: Option<IliacCrests>,
    /// The reading.
    pub reading: &'a Reading<VertebraLandmarks>,
    /// The end vertebrae of the Cobb angles.
    pub curves: &'a [(Region, CobbEnds)],
    /// The radiograph.
    pub source: &'a SourceImage,
    /// Date and time of the report in UTC, as DICOM writes them.
    pub written: [&'a str; 2],
}
