//! The core's evidence types in a decoder's answer.

pub(super) mod spacing {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use spineline_marking::{CalibrationType, SpacingEvidence};

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Record {
        pixel_mm: Option<[f64; 2]>,
        fiducial: Option<bool>,
        imager_mm: Option<[f64; 2]>,
        magnification: Option<f64>,
        source_to_detector_mm: Option<f64>,
        source_to_patient_mm: Option<f64>,
        scanned_mm: Option<[f64; 2]>,
        pixel_aspect: Option<f64>,
    }

    pub(crate) fn serialize<S: Serializer>(e: &SpacingEvidence, to: S) -> Result<S::Ok, S::Error> {
        Record {
            pixel_mm: e.pixel_mm,
            fiducial: e.calibration.map(|kind| kind == CalibrationType::Fiducial),
            imager_mm: e.imager_mm,
            magnification: e.magnification,
            source_to_detector_mm: e.source_to_detector_mm,
            source_to_patient_mm: e.source_to_patient_mm,
            scanned_mm: e.scanned_mm,
            pixel_aspect: e.pixel_aspect,
        }
        .serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<SpacingEvidence, D::Error> {
        let record = Record::deserialize(from)?;
        let calibration = |fiducial| match fiducial {
            true => CalibrationType::Fiducial,
            false => CalibrationType::Geometry,
        };
        Ok(SpacingEvidence {
            pixel_mm: record.pixel_mm,
            calibration: record.fiducial.map(calibration),
            imager_mm: record.imager_mm,
            magnification: record.magnification,
            source_to_detector_mm: record.source_to_detector_mm,
            source_to_patient_mm: record.source_to_patient_mm,
            scanned_mm: record.scanned_mm,
            pixel_aspect: record.pixel_aspect,
        })
    }
}

pub(super) mod view {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};
    use spineline_marking::{PatientDirection, Stance, ViewEvidence, ViewPosition};

    #[derive(Serialize, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Record {
        orientation: Option<[char; 2]>,
        position: Option<Position>,
        erect: Option<bool>,
    }

    #[derive(Serialize, Deserialize)]
    enum Position {
        Frontal,
        Lateral,
        Other,
    }

    const fn letter(direction: PatientDirection) -> char {
        match direction {
            PatientDirection::Left => 'L',
            PatientDirection::Right => 'R',
            PatientDirection::Anterior => 'A',
            PatientDirection::Posterior => 'P',
            PatientDirection::Head => 'H',
            PatientDirection::Foot => 'F',
        }
    }

    pub(crate) fn serialize<S: Serializer>(e: &ViewEvidence, to: S) -> Result<S::Ok, S::Error> {
        Record {
            orientation: e.orientation.map(|pair| pair.map(letter)),
            position: e.view_position.map(|position| match position {
                ViewPosition::Frontal => Position::Frontal,
                ViewPosition::Lateral => Position::Lateral,
                ViewPosition::Other => Position::Other,
            }),
            erect: e.stance.map(|stance| stance == Stance::Erect),
        }
        .serialize(to)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<ViewEvidence, D::Error> {
        let record = Record::deserialize(from)?;
        let direction = |letter: char| {
            let no_direction = || serde::de::Error::custom("no direction");
            PatientDirection::from_dicom(letter.encode_utf8(&mut [0; 4])).ok_or_else(no_direction)
        };
        let orientation = match record.orientation {
            Some([columns, rows]) => Some([direction(columns)?, direction(rows)?]),
            None => None,
        };
        Ok(ViewEvidence {
            orientation,
            view_position: record.position.map(|position| match position {
                Position::Frontal => ViewPosition::Frontal,
                Position::Lateral => ViewPosition::Lateral,
                Position::Other => ViewPosition::Other,
            }),
            stance: record.erect.map(|erect| if erect { Stance::Erect } else { Stance::Recumbent }),
        })
    }
}
