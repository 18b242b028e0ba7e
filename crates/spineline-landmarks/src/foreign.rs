//! Files of other programs without readable landmarks: their kind, and a remedy.

use spineline_files::column_name;

use super::LandmarkError;
use super::json::Outline;

/// Kind of a file, and the remedy.
type Known = (&'static str, &'static str);

const AS_COCO: &str = "export the key points as COCO JSON, or write a table with the columns of `spineline export --to csv`";
const AS_TABLE: &str = "write a table with the columns of `spineline export --to csv`";
const AS_CSV: &str = "save the sheet as CSV";
const UNPACK: &str = "unpack it, and give the file of landmarks in it";
const FILMS: &str = "give films as PATH, and landmarks in a separate file with `--landmarks`";
const SAVE_V7: &str = "save it in MATLAB with save('file.mat', 'p2', '-v7')";

/// First bytes of binary files.
const SIGNATURES: [(&[u8], Known); 20] = [
    (b"MATLAB 7.3", ("a MATLAB file of version 7.3 (HDF5)", SAVE_V7)),
    (b"\x89HDF", ("an HDF5 file, such as of MATLAB 7.3, DeepLabCut or SLEAP", SAVE_V7)),
    (b"\x89PNG", ("a PNG picture", FILMS)),
    (b"\xff\xd8\xff", ("a JPEG picture", FILMS)),
    (b"II*\0", ("a TIFF picture", FILMS)),
    (b"MM\0*", ("a TIFF picture", FILMS)),
    (b"II+\0", ("a TIFF picture", FILMS)),
    (b"MM\0+", ("a TIFF picture", FILMS)),
    (b"%PDF", ("a PDF document", AS_TABLE)),
    (
        b"Iout",
        (
            "an ROI of ImageJ",
            "save the points in ImageJ as a table, and name its columns as in `spineline export --to csv`",
        ),
    ),
    (b"\xd0\xcf\x11\xe0", ("an Office document, such as an old Excel sheet (.xls)", AS_CSV)),
    (b"{\\rtf", ("a text with formats (RTF)", AS_CSV)),
    (b"\x1f\x8b", ("a compressed file (gzip)", UNPACK)),
    (b"7z\xbc\xaf", ("a 7z archive", UNPACK)),
    (b"Rar!", ("a RAR archive", UNPACK)),
    (b"BZh", ("a compressed file (bzip2)", UNPACK)),
    (b"\x93NUMPY", ("an array of NumPy", AS_TABLE)),
    (b"SQLite format 3", ("an SQLite database", AS_TABLE)),
    (b"PAR1", ("a Parquet file", AS_TABLE)),
    (b"\x80\x04\x95", ("a pickle of Python", AS_TABLE)),
];

/// The error for a file of another program that is known by its first bytes.
pub(super) fn by_signature(bytes: &[u8]) -> Option<LandmarkError> {
    let listed = SIGNATURES.iter().find(|(signature, _)| bytes.starts_with(signature));
    let known = listed.map(|(_, known)| *known).or_else(|| match bytes {
        [b'P', b'K', 3 | 5, 4 | 6, ..] => Some(zip_of(bytes)),
        _ if bytes.get(4..8) == Some(b"ftyp") => {
            Some(("a HEIC or AVIF picture, or a film clip", FILMS))
        }
        _ if is_matlab_4(bytes) => Some(("a MATLAB file of version 4", SAVE_V7)),
        _ => None,
    });
    known.map(error)
}

/// The error for a text of another program.
pub(super) fn by_text(text: &str) -> Option<LandmarkError> {
    let start = text.trim_start();
    let begins = |word: &str| start.starts_with(word);
    let first_line = column_name(start.lines().next().unwrap_or_default());
    let known = if start.is_empty() {
        ("empty", "give the file of landmarks")
    } else if begins("# Markups fiducial file") {
        ("an old point list of 3D Slicer (.fcsv)", "save the list in 3D Slicer as .mrk.json")
    } else if begins("<MRML") {
        ("a scene of 3D Slicer (.mrml)", "save the point lists in 3D Slicer as .mrk.json")
    } else if begins("<") {
        xml_of(text)
    } else if first_line.starts_with("scorer,") {
        ("a table of DeepLabCut", AS_TABLE)
    } else if first_line.contains("region_shape_attributes") {
        (
            "a table of the VGG Image Annotator (VIA)",
            "export it in VIA as COCO with key points, or as a table with the columns of `spineline export --to csv`",
        )
    } else if first_line.contains("axis_0") && first_line.contains("axis_1") {
        ("a table of points of napari", AS_TABLE)
    } else if is_yolo(start) {
        ("a list of YOLO, which names no vertebra", AS_COCO)
    } else {
        return None;
    };
    Some(error(known))
}

const LABEL_STUDIO: Known = (
    "an export of Label Studio in its own format (JSON or JSON-MIN)",
    "export it in Label Studio as COCO, which has key points since 2025; or write a table with the columns of `spineline export --to csv`",
);

/// The error for an object in JSON of another program.
pub(super) fn by_json(outline: &Outline) -> Option<LandmarkError> {
    let has = |key: &str| outline.has(key);
    let known = if is_task(outline) {
        LABEL_STUDIO
    } else if has("_via_img_metadata") || outline.of_first.iter().any(|key| key == "regions") {
        ("a project of the VGG Image Annotator (VIA)", "export it in VIA as COCO with key points")
    } else if has("data_row") || has("DataRow ID") {
        ("an export of Labelbox", AS_COCO)
    } else if has("item") && has("annotations") {
        ("an export of V7 Darwin", AS_COCO)
    } else if has("objects") {
        ("an annotation of Supervisely", AS_COCO)
    } else if has("skeletons") || has("tracks") || has("items") {
        (
            "an export of CVAT or Datumaro in its own format",
            "export it in CVAT as COCO Keypoints 1.0",
        )
    } else {
        return None;
    };
    Some(error(known))
}

/// The error for a list in JSON: landmark files are objects.
pub(super) fn by_json_list(outline: &Outline) -> LandmarkError {
    let has = |key: &str| outline.has(key);
    error(if is_task(outline) {
        LABEL_STUDIO
    } else if has("data_row") || has("DataRow ID") {
        ("an export of Labelbox", AS_COCO)
    } else if has("keypoints") || has("category_id") {
        (
            "a list of COCO results, which names no pictures and keypoints",
            "put it into `annotations` of its dataset, which has `images` and `categories`",
        )
    } else {
        ("a list in JSON, not a known landmark file", AS_COCO)
    })
}

/// Whether it is a task of Label Studio, in JSON or JSON-MIN.
fn is_task(outline: &Outline) -> bool {
    let has = |key: &str| outline.has(key);
    let full = has("data") && (has("annotations") || has("completions") || has("predictions"));
    let min = has("annotation_id") && has("annotator") || has("lead_time") && has("created_at");
    full || min
}

fn error((what, help): Known) -> LandmarkError {
    LandmarkError::Foreign { what, help }
}

fn zip_of(bytes: &[u8]) -> Known {
    let has = |name: &[u8]| bytes.windows(name.len()).take(1 << 16).any(|part| part == name);
    let ends = bytes.get(bytes.len().saturating_sub(1 << 16)..).unwrap_or_default();
    let lists = |name: &[u8]| has(name) || ends.windows(name.len()).any(|part| part == name);
    if lists(b"xl/workbook") || lists(b"opendocument.spreadsheet") {
        ("a sheet of a spreadsheet program (.xlsx or .ods)", AS_CSV)
    } else if lists(b"word/document") || lists(b"ppt/presentation") {
        ("an Office document", AS_CSV)
    } else if lists(b".roi") {
        (
            "a set of ROIs of ImageJ",
            "save the points in ImageJ as a table, and name its columns as in `spineline export --to csv`",
        )
    } else if lists(b".mrml") {
        ("a scene of 3D Slicer (.mrb)", "save the point lists in 3D Slicer as .mrk.json")
    } else {
        ("a ZIP archive", UNPACK)
    }
}

fn xml_of(text: &str) -> Known {
    let has = |word: &str| text.contains(word);
    if has("<annotations>") && (has("<image ") || has("<meta>")) {
        ("an export of CVAT for images (XML)", "export it in CVAT as COCO Keypoints 1.0")
    } else if has("<annotation>") {
        ("an annotation of Pascal VOC (XML), which has boxes and no corners", AS_COCO)
    } else if has("<!DOCTYPE html") || has("<html") {
        ("a web page", "download the file itself")
    } else {
        ("XML, not a known landmark file", AS_COCO)
    }
}

/// Lines of a class and numbers, without words.
fn is_yolo(text: &str) -> bool {
    let mut cells = text.lines().take(3).flat_map(str::split_whitespace).peekable();
    let five = text.lines().next().is_some_and(|line| line.split_whitespace().count() >= 5);
    five && cells.peek().is_some() && cells.all(|cell| cell.parse::<f64>().is_ok())
}

/// The header of a variable in MATLAB 4: its type, rows, columns, whether it is complex, and the length of its name, which ends in a
/// zero.
fn is_matlab_4(bytes: &[u8]) -> bool {
    let word = |place: usize| {
        let four = bytes.get(4 * place..4 * place + 4)?;
        let four = [four[0], four[1], four[2], four[3]];
        // Types with the other byte order start at 1000.
        Some([u32::from_le_bytes(four), u32::from_be_bytes(four)])
    };
    let Some([kinds, rows, columns, complex, length]) = (0..5)
        .map(word)
        .collect::<Option<Vec<_>>>()
        .and_then(|words| <[_; 5]>::try_from(words).ok())
    else {
        return false;
    };
    (0..2).any(|order| {
        let (kind, name) = (kinds[order], length[order] as usize);
        let digits = [kind / 1000, kind / 100 % 10, kind / 10 % 10, kind % 10];
        let is_kind = digits[0] <= 4 && digits[1] == 0 && digits[2] <= 5 && digits[3] <= 2;
        let is_size = [rows, columns].iter().all(|size| (1..1 << 24).contains(&size[order]));
        let text = (1..64).contains(&name).then(|| bytes.get(20..20 + name)).flatten();
        let is_name = text.and_then(<[u8]>::split_last).is_some_and(|(last, name)| {
            *last == 0
                && name.iter().all(|letter| letter.is_ascii_alphanumeric() || *letter == b'_')
        });
        is_kind && is_size && complex[order] <= 1 && is_name
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(error: Option<LandmarkError>) -> String {
        error.map_or_else(String::new, |error| format!("{error}; {}", error.help()))
    }

    #[test]
    fn files_of_other_programs_are_named_by_their_first_bytes() {
        let matlab_4 = [
            &0_u32.to_le_bytes()[..],
            &68_u32.to_le_bytes(),
            &2_u32.to_le_bytes(),
            &0_u32.to_le_bytes(),
            &3_u32.to_le_bytes(),
            b"p2\0",
        ]
        .concat();
        let mut big: Vec<u8> = vec![0, 0, 3, 0xe8, 0, 0, 0, 68, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 3];
        big.extend(b"p2\0");
        for (bytes, words) in [
            (&b"MATLAB 7.3 MAT-file, Platform: GLNXA64"[..], "MATLAB file of version 7.3"),
            (&matlab_4, "MATLAB file of version 4"),
            (&big, "MATLAB file of version 4"),
            (b"PK\x03\x04....xl/workbook.xml", "spreadsheet"),
            (b"PK\x03\x04....a.roi", "ROIs of ImageJ"),
            (b"PK\x03\x04....landmarks.json", "ZIP archive"),
            (b"Iout\0\xe4", "ROI of ImageJ"),
            (b"%PDF-1.7", "PDF"),
            (b"\0\0\0\x18ftypheic", "HEIC"),
            (b"\x89PNG\r\n", "PNG picture"),
        ] {
            let said = said(by_signature(bytes));
            assert!(said.contains(words), "{said}");
        }
        assert!(said(by_signature(&matlab_4)).contains("-v7"));
        for bytes in [&b"vertebra,x"[..], b"", b"{\"images\": []}", b"MATLAB 5.0 MAT-file"] {
            assert!(by_signature(bytes).is_none());
        }
    }

    #[test]
    fn texts_of_other_programs_are_named() {
        for (text, words) in [
            ("", "empty"),
            ("# Markups fiducial file version = 4.11\n", "fcsv"),
            ("<?xml version=\"1.0\"?>\n<annotations>\n<meta>", "CVAT"),
            ("<annotation><folder>", "Pascal VOC"),
            ("0 0.5 0.5 0.1 0.1\n0 0.5 0.4 0.1 0.1", "YOLO"),
            ("filename,file_size,region_shape_attributes\n", "VIA"),
            ("scorer,DLC\nbodyparts,a", "DeepLabCut"),
        ] {
            let said = said(by_text(text));
            assert!(said.contains(words), "{text}: {said}");
        }
        assert!(by_text("posture,vertebra\nerect,L4").is_none());
    }

    #[test]
    fn json_of_other_programs_is_named() {
        for (text, words) in [
            (r#"[{"id": 1, "data": {"image": "a.png"}, "annotations": []}]"#, "Label Studio"),
            (r#"{"id": 1, "data": {}, "annotations": []}"#, "Label Studio"),
            (r#"{"_via_settings": {}, "_via_img_metadata": {}}"#, "VIA"),
            (r#"{"a.png123": {"filename": "a.png", "regions": []}}"#, "VIA"),
            (r#"[{"image_id": 1, "keypoints": []}]"#, "COCO results"),
            (r#"{"description": "", "objects": []}"#, "Supervisely"),
        ] {
            let outline: Outline = serde_json::from_str(text).expect(text);
            let error =
                if outline.is_list { Some(by_json_list(&outline)) } else { by_json(&outline) };
            let said = said(error);
            assert!(said.contains(words), "{text}: {said}");
        }
        let coco: Outline =
            serde_json::from_str(r#"{"images": [], "annotations": []}"#).expect("JSON");
        assert!(by_json(&coco).is_none());
    }
}
