//! Checks of the header of a JPEG 2000 picture, before the decoder allocates memory.

use super::Format;
use super::markers::has_end;
use crate::error::CodecFault;

/// Maximum number of tiles: a film has one, or a few hundred, and each costs memory.
const MAX_TILES: u64 = 4096;

/// Checks that a picture agrees with the data set and has an end.
pub(super) fn check(data: &[u8], format: Format) -> Result<(), CodecFault> {
    Size::read(data)?.check(format)?;
    has_end(data)
}

/// The image and tile size segment (ITU-T T.800, A.5.1).
struct Size {
    image: [u32; 2],
    offset: [u32; 2],
    tile: [u32; 2],
    components: u16,
    bits: u8,
    signed: bool,
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
            signed: body[36] & 0x80 != 0,
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
        // Negative values would become large ones.
        if self.signed && !format.signed {
            return Err(CodecFault::Unsupported);
        }
        if self.tile.contains(&0) || self.sub_sampled {
            return Err(CodecFault::Header);
        }
        let tiles = [0, 1].map(|axis| u64::from(self.image[axis].div_ceil(self.tile[axis])));
        if tiles[0] * tiles[1] > MAX_TILES {
            return Err(CodecFault::Unsupported);
        }
        Ok(())
    }
}
