//! JPEG 2000, by openjp2.

use jpeg2k::{DecodeParameters, Image};

use super::super::error::CodecFault;
use super::super::pixels::{Coded, Format};
use super::foreign;

/// Tiles that a codestream may have: a film has one, or a few hundred; each costs memory of its own.
const MOST_TILES: u64 = 4096;

pub(super) fn decode(data: &[u8], format: Format) -> Result<Coded, CodecFault> {
    let size = Size::read(data)?;
    size.check(format)?;
    let parameters = DecodeParameters::new().strict(true);
    let image = foreign(|| Image::from_bytes_with(data, parameters))?;
    let [component] = image.components() else {
        return Err(CodecFault::Components { count: size.components });
    };
    let values = component.data();
    if values.len() != format.pixels() {
        return Err(CodecFault::Corrupt);
    }
    if !format.signed && values.iter().any(|&value| value < 0) {
        return Err(CodecFault::Unsupported);
    }
    // Two's complement of the low 16 bits; the component has no more.
    Ok(Coded::Words(values.iter().map(|&value| value as u16).collect()))
}

/// The image and tile size segment (ITU-T T.800, A.5.1).
struct Size {
    image: [u32; 2],
    offset: [u32; 2],
    tile: [u32; 2],
    components: u16,
    bits: u8,
    sub_sampled: bool,
}

impl Size {
    fn read(data: &[u8]) -> Result<Self, CodecFault> {
        // DICOM holds the bare codestream; some writers put it into a file format, whose boxes come first.
        const START: [u8; 4] = [0xFF, 0x4F, 0xFF, 0x51];
        let head = &data[..data.len().min(4096)];
        let start = head.windows(4).position(|window| window == START);
        let start = start.ok_or(CodecFault::Header)? + START.len() + 2;
        let body = data.get(start..).and_then(<[u8]>::first_chunk::<39>);
        let body = body.ok_or(CodecFault::Truncated)?;
        let at = |index: usize| {
            let start = 2 + 4 * index;
            u32::from_be_bytes([body[start], body[start + 1], body[start + 2], body[start + 3]])
        };
        Ok(Self {
            image: [at(0), at(1)],
            offset: [at(2), at(3)],
            tile: [at(4), at(5)],
            components: u16::from_be_bytes([body[34], body[35]]),
            bits: (body[36] & 0x7F).saturating_add(1),
            sub_sampled: body[37..39] != [1, 1],
        })
    }

    fn check(&self, format: Format) -> Result<(), CodecFault> {
        let stated = [u32::from(format.columns), u32::from(format.rows)];
        let coded = [0, 1].map(|axis| self.image[axis].saturating_sub(self.offset[axis]));
        if coded != stated {
            return Err(CodecFault::Size { coded, stated });
        }
        if self.components != 1 || format.samples != 1 {
            return Err(CodecFault::Components { count: self.components });
        }
        if self.bits > format.allocated {
            return Err(CodecFault::Precision { bits: self.bits });
        }
        if self.tile.contains(&0) || self.sub_sampled {
            return Err(CodecFault::Header);
        }
        let tiles = [0, 1].map(|axis| u64::from(self.image[axis].div_ceil(self.tile[axis])));
        if tiles[0] * tiles[1] > MOST_TILES {
            return Err(CodecFault::Unsupported);
        }
        Ok(())
    }
}
