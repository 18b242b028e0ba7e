//! Films made element by element with independent encoders, so that the expected values are known.
#![allow(dead_code, missing_docs, clippy::unwrap_used)]

use std::collections::BTreeMap;

pub type Tag = (u16, u16);

/// Encoding of a film.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Syntax {
    pub uid: &'static str,
    pub explicit: bool,
    pub big_endian: bool,
}

pub const IMPLICIT: Syntax =
    Syntax { uid: "1.2.840.10008.1.2", explicit: false, big_endian: false };
pub const EXPLICIT: Syntax =
    Syntax { uid: "1.2.840.10008.1.2.1", explicit: true, big_endian: false };
pub const BIG_ENDIAN: Syntax =
    Syntax { uid: "1.2.840.10008.1.2.2", explicit: true, big_endian: true };
pub const DEFLATED: Syntax = Syntax { uid: "1.2.840.10008.1.2.1.99", ..EXPLICIT };
pub const JPEG: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.50", ..EXPLICIT };
pub const JPEG_EXTENDED: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.51", ..EXPLICIT };
pub const JPEG_LOSSLESS: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.57", ..EXPLICIT };
pub const JPEG_LOSSLESS_1: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.70", ..EXPLICIT };
pub const JPEG_LS: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.80", ..EXPLICIT };
pub const JPEG_2000: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.90", ..EXPLICIT };
pub const HTJ2K: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.201", ..EXPLICIT };
pub const HTJ2K_RPCL: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.202", ..EXPLICIT };
pub const HTJ2K_LOSSY: Syntax = Syntax { uid: "1.2.840.10008.1.2.4.203", ..EXPLICIT };
pub const RLE: Syntax = Syntax { uid: "1.2.840.10008.1.2.5", ..EXPLICIT };

/// The value of an element.
#[derive(Clone)]
pub enum Value {
    Bytes(Vec<u8>),
    Words(Vec<u16>),
    Items(Vec<BTreeMap<Tag, (&'static str, Value)>>),
    Fragments(Vec<Vec<u8>>),
}

#[derive(Clone)]
pub struct Maker {
    pub elements: BTreeMap<Tag, (&'static str, Value)>,
    pub preamble: Vec<u8>,
    pub meta: BTreeMap<Tag, (&'static str, Value)>,
}

/// A grey film of 12 bits in 16, with a different value for each pixel.
pub fn ramp(columns: u16, rows: u16) -> Vec<u16> {
    (0..u32::from(columns) * u32::from(rows)).map(|i| (i * 37 % 4096) as u16).collect()
}

pub fn text(value: &str) -> Value {
    Value::Bytes(value.as_bytes().to_vec())
}

impl Maker {
    pub fn new(columns: u16, rows: u16, pixels: &[u16]) -> Self {
        let mut maker =
            Self { elements: BTreeMap::new(), preamble: vec![0; 128], meta: BTreeMap::new() };
        maker.text((0x0008, 0x0016), "UI", "1.2.840.10008.5.1.4.1.1.1");
        maker.text((0x0008, 0x0018), "UI", "1.2.3.4.5.1");
        maker.text((0x0008, 0x0060), "CS", "CR");
        maker.text((0x0020, 0x000D), "UI", "1.2.3.4.5.2");
        maker.text((0x0020, 0x000E), "UI", "1.2.3.4.5.3");
        maker.text((0x0028, 0x0004), "CS", "MONOCHROME2");
        maker
            .word((0x0028, 0x0002), 1)
            .word((0x0028, 0x0010), rows)
            .word((0x0028, 0x0011), columns);
        maker.word((0x0028, 0x0100), 16).word((0x0028, 0x0101), 12).word((0x0028, 0x0102), 11);
        maker.word((0x0028, 0x0103), 0);
        maker.text((0x0028, 0x0301), "CS", "NO");
        maker.set((0x7FE0, 0x0010), "OW", Value::Words(pixels.to_vec()));
        maker
    }

    pub fn set(&mut self, tag: Tag, vr: &'static str, value: Value) -> &mut Self {
        self.elements.insert(tag, (vr, value));
        self
    }

    pub fn text(&mut self, tag: Tag, vr: &'static str, value: &str) -> &mut Self {
        self.set(tag, vr, text(value))
    }

    pub fn word(&mut self, tag: Tag, value: u16) -> &mut Self {
        self.set(tag, "US", Value::Words(vec![value]))
    }

    pub fn remove(&mut self, tag: Tag) -> &mut Self {
        self.elements.remove(&tag);
        self
    }

    pub fn fragments(&mut self, fragments: Vec<Vec<u8>>) -> &mut Self {
        self.set((0x7FE0, 0x0010), "OB", Value::Fragments(fragments))
    }

    /// Only the data set.
    pub fn body(&self, syntax: Syntax) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&self.elements, syntax, &mut bytes);
        bytes
    }

    /// A whole file.
    pub fn file(&self, syntax: Syntax) -> Vec<u8> {
        let mut meta = self.meta.clone();
        meta.insert((2, 0x10), ("UI", text(syntax.uid)));
        let mut bytes = self.preamble.clone();
        bytes.extend_from_slice(b"DICM");
        write(&meta, EXPLICIT, &mut bytes);
        let body = self.body(syntax);
        if syntax == DEFLATED {
            use std::io::Write;
            let mut encoder =
                flate2::write::DeflateEncoder::new(bytes, flate2::Compression::default());
            encoder.write_all(&body).unwrap();
            return encoder.finish().unwrap();
        }
        bytes.extend(body);
        bytes
    }
}

fn write(elements: &BTreeMap<Tag, (&'static str, Value)>, syntax: Syntax, to: &mut Vec<u8>) {
    let word =
        |value: u16| if syntax.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let long =
        |value: u32| if syntax.big_endian { value.to_be_bytes() } else { value.to_le_bytes() };
    let mark = |element: u16, length: u32, to: &mut Vec<u8>| {
        to.extend(word(0xFFFE));
        to.extend(word(element));
        to.extend(long(length));
    };
    for (tag, (vr, value)) in elements {
        to.extend(word(tag.0));
        to.extend(word(tag.1));
        let body: Vec<u8> = match value {
            Value::Bytes(bytes) => bytes.clone(),
            Value::Words(words) => words.iter().flat_map(|&w| word(w)).collect(),
            Value::Items(_) | Value::Fragments(_) => Vec::new(),
        };
        let length = match value {
            Value::Items(_) | Value::Fragments(_) => u32::MAX,
            _ => (body.len() + body.len() % 2) as u32,
        };
        if syntax.explicit {
            to.extend(vr.as_bytes());
            if ["OB", "OD", "OF", "OL", "OV", "OW", "SQ", "UC", "UN", "UR", "UT", "UV", "SV"]
                .contains(vr)
            {
                to.extend([0, 0]);
                to.extend(long(length));
            } else {
                to.extend(word(length as u16));
            }
        } else {
            to.extend(long(length));
        }
        to.extend(&body);
        if body.len() % 2 == 1 {
            to.push(if ["UI", "OB", "UN"].contains(vr) { 0 } else { b' ' });
        }
        match value {
            Value::Items(items) => {
                for item in items {
                    mark(0xE000, u32::MAX, to);
                    write(item, syntax, to);
                    mark(0xE00D, 0, to);
                }
                mark(0xE0DD, 0, to);
            }
            Value::Fragments(fragments) => {
                mark(0xE000, 0, to);
                for fragment in fragments {
                    mark(0xE000, (fragment.len() + fragment.len() % 2) as u32, to);
                    to.extend(fragment);
                    to.extend(vec![0; fragment.len() % 2]);
                }
                mark(0xE0DD, 0, to);
            }
            _ => {}
        }
    }
}

/// Run lengths of 16-bit words.
pub fn rle(pixels: &[u16]) -> Vec<u8> {
    let plane = |shift: u16| {
        let bytes: Vec<u8> = pixels.iter().map(|&p| (p >> shift) as u8).collect();
        let mut out = Vec::new();
        let mut rest = &bytes[..];
        while let Some(&first) = rest.first() {
            let run = rest.iter().take(128).take_while(|&&b| b == first).count();
            if run >= 2 {
                out.extend([(257 - run) as u8, first]);
                rest = &rest[run..];
            } else {
                let stop = rest.windows(2).take(127).position(|pair| pair[0] == pair[1]);
                let literal = stop.unwrap_or(rest.len().min(128));
                out.push((literal - 1) as u8);
                out.extend(&rest[..literal]);
                rest = &rest[literal..];
            }
        }
        if out.len() % 2 == 1 {
            out.push(0);
        }
        out
    };
    let (high, low) = (plane(8), plane(0));
    let mut header = [0_u32; 16];
    header[..3].copy_from_slice(&[2, 64, 64 + high.len() as u32]);
    let mut bytes: Vec<u8> = header.iter().flat_map(|word| word.to_le_bytes()).collect();
    bytes.extend(high);
    bytes.extend(low);
    bytes
}

struct BitWriter {
    bytes: Vec<u8>,
    held: u64,
    count: u32,
}

impl BitWriter {
    fn put(&mut self, value: u32, bits: u32) {
        self.held = self.held << bits | u64::from(value);
        self.count += bits;
        while self.count >= 8 {
            self.count -= 8;
            let byte = (self.held >> self.count) as u8;
            self.bytes.push(byte);
            if byte == 0xFF {
                self.bytes.push(0);
            }
        }
        self.held &= (1 << self.count) - 1;
    }

    fn flush(&mut self) {
        if self.count > 0 {
            self.put((1 << (8 - self.count)) - 1, 8 - self.count);
        }
    }
}

/// Lossless JPEG with one predictor, a restart marker after `restart_lines` lines (0 for none), and `shift` low bits
/// dropped.
pub fn jpeg_lossless(
    columns: u16,
    rows: u16,
    bits: u8,
    pixels: &[u16],
    predictor: u8,
    restart_lines: u16,
    shift: u8,
) -> Vec<u8> {
    // Seven codes of 3 bits for differences below 64, then one of each length.
    let code = |category: u32| match category {
        0..=6 => (category, 3),
        _ => {
            let extra = category - 7;
            (((1 << (extra + 1)) - 2) | (0b111 << (extra + 1)), 4 + extra)
        }
    };
    let mut bytes = jpeg_lossless_header([columns, rows], bits, restart_lines);
    bytes.extend([0xFF, 0xDA, 0, 8, 1, 1, 0, predictor, 0, shift]);
    let mut writer = BitWriter { bytes, held: 0, count: 0 };
    let width = usize::from(columns);
    let at = |x: usize, y: usize| i32::from(pixels[y * width + x] >> shift);
    for y in 0..usize::from(rows) {
        let fresh = restart_lines > 0 && y % usize::from(restart_lines) == 0;
        if fresh && y > 0 {
            writer.flush();
            let number = (y / usize::from(restart_lines) - 1) % 8;
            writer.bytes.extend([0xFF, 0xD0 + number as u8]);
        }
        let first = y == 0 || fresh;
        for x in 0..width {
            let prediction = match (x, first) {
                (0, true) => 1 << (bits - shift - 1),
                (0, false) => at(0, y - 1),
                (_, true) => at(x - 1, y),
                (_, false) => predicted(predictor, [at(x - 1, y), at(x, y - 1), at(x - 1, y - 1)]),
            };
            let difference = i32::from((at(x, y) - prediction) as i16);
            let category = 32 - difference.unsigned_abs().leading_zeros();
            let (value, length) = code(category);
            writer.put(value, length);
            if (1..16).contains(&category) {
                let raw = if difference < 0 { difference - 1 } else { difference };
                writer.put(raw as u32 & ((1 << category) - 1), category);
            }
        }
    }
    writer.flush();
    writer.bytes.extend([0xFF, 0xD9]);
    writer.bytes
}

/// The part before the scan: size, codes and the distance of restart markers.
fn jpeg_lossless_header([columns, rows]: [u16; 2], bits: u8, restart_lines: u16) -> Vec<u8> {
    let mut bytes = vec![0xFF, 0xD8, 0xFF, 0xC3, 0, 11, bits];
    bytes.extend(rows.to_be_bytes());
    bytes.extend(columns.to_be_bytes());
    bytes.extend([1, 1, 0x11, 0, 0xFF, 0xC4, 0, 19 + 17, 0]);
    bytes.extend([0, 0, 7, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0]);
    bytes.extend(0..17_u8);
    if restart_lines > 0 {
        bytes.extend([0xFF, 0xDD, 0, 4]);
        bytes.extend((restart_lines * columns).to_be_bytes());
    }
    bytes
}

/// A pixel predicted from its left, upper and upper left neighbours.
fn predicted(predictor: u8, [a, b, c]: [i32; 3]) -> i32 {
    match predictor {
        1 => a,
        2 => b,
        3 => c,
        4 => a + b - c,
        5 => a + ((b - c) >> 1),
        6 => b + ((a - c) >> 1),
        _ => (a + b) >> 1,
    }
}

/// JPEG-LS without losses.
pub fn jpeg_ls(columns: u16, rows: u16, bits: u8, pixels: &[u16]) -> Vec<u8> {
    let mut options = jpegls::EncodeOptions::default();
    let (columns, rows) = (u32::from(columns), u32::from(rows));
    options.precision = Some(bits);
    let mut bytes = Vec::new();
    jpegls::encode_with_options(pixels, columns, rows, &options, &mut bytes).unwrap();
    bytes
}
