//! Huffman codes and the bits of a scan, as JPEG writes them (ITU-T T.81, annexes C and F).

use super::super::error::CodecFault;

/// Bits that one look-up takes in; longer codes are rare.
const FAST_BITS: u32 = 11;

/// The codes of one table; a symbol is the number of bits of a difference, 0 to 16.
pub(super) struct Table {
    /// By the next bits: length of the code and its symbol; a length of 0 if the code is longer.
    fast: Vec<(u8, u8)>,
    /// By length: one more than the largest code, aligned to 16 bits, and the symbol index minus its code.
    ends: [u32; 17],
    offsets: [i32; 17],
    symbols: Vec<u8>,
}

impl Table {
    /// Reads a table of a DHT segment: class and number, and the table. Returns what follows it.
    pub fn read(body: &[u8]) -> Result<(u8, Self, &[u8]), CodecFault> {
        let (&number, rest) = body.split_first().ok_or(CodecFault::Header)?;
        let (counts, rest) = rest.split_first_chunk::<16>().ok_or(CodecFault::Header)?;
        let total: usize = counts.iter().map(|&count| usize::from(count)).sum();
        let (symbols, rest) = rest.split_at_checked(total).ok_or(CodecFault::Header)?;
        if number & 0xF0 == 0 && symbols.iter().any(|&symbol| symbol > 16) {
            return Err(CodecFault::Header);
        }
        let mut table = Self {
            fast: vec![(0, 0); 1 << FAST_BITS],
            ends: [0; 17],
            offsets: [0; 17],
            symbols: symbols.to_vec(),
        };
        let (mut code, mut index) = (0_u32, 0_usize);
        for (length, &count) in (1_u32..).zip(counts) {
            let first = code;
            // At most 256 symbols.
            table.offsets[length as usize] = index as i32 - first as i32;
            for _ in 0..count {
                if code >= 1 << length {
                    return Err(CodecFault::Header);
                }
                if length <= FAST_BITS {
                    let free = FAST_BITS - length;
                    let from = (code << free) as usize;
                    table.fast[from..from + (1 << free)].fill((length as u8, symbols[index]));
                }
                code += 1;
                index += 1;
            }
            table.ends[length as usize] = code << (16 - length);
            code <<= 1;
        }
        Ok((number, table, rest))
    }

    /// The next symbol.
    #[inline]
    pub fn next(&self, bits: &mut Bits<'_>) -> Result<u8, CodecFault> {
        let (length, symbol) = self.fast[bits.peek(FAST_BITS) as usize];
        if length != 0 {
            bits.skip(u32::from(length));
            return Ok(symbol);
        }
        let word = bits.peek(16);
        for length in FAST_BITS + 1..=16 {
            if word < self.ends[length as usize] {
                let code = (word >> (16 - length)) as i32;
                let index = usize::try_from(code + self.offsets[length as usize]);
                let symbol = index.ok().and_then(|index| self.symbols.get(index));
                bits.skip(length);
                return symbol.copied().ok_or(CodecFault::Corrupt);
            }
        }
        Err(CodecFault::Corrupt)
    }
}

/// The bits of a scan, up to its next marker.
pub(super) struct Bits<'a> {
    data: &'a [u8],
    position: usize,
    /// The lowest `count` bits are next.
    held: u64,
    count: u32,
    /// Zeros that were given out in place of missing bits.
    lent: u32,
}

impl<'a> Bits<'a> {
    pub const fn new(data: &'a [u8], position: usize) -> Self {
        Self { data, position, held: 0, count: 0, lent: 0 }
    }

    /// Makes at least 33 bits available; beyond the end they are zeros.
    #[inline]
    pub fn fill(&mut self) {
        if self.count > 32 {
            return;
        }
        if let Some(&chunk) = self.data[self.position..].first_chunk::<4>() {
            let word = u32::from_be_bytes(chunk);
            // Whether one of the bytes is 0xFF.
            let inverse = !word;
            if inverse.wrapping_sub(0x0101_0101) & word & 0x8080_8080 == 0 {
                self.held = self.held << 32 | u64::from(word);
                self.count += 32;
                self.position += 4;
                return;
            }
        }
        self.fill_slowly();
    }

    #[cold]
    fn fill_slowly(&mut self) {
        while self.count <= 32 {
            let next = self.data[self.position..].first_chunk::<2>();
            let byte = match (self.data.get(self.position), next) {
                (Some(0xFF), Some([_, 0])) => {
                    self.position += 2;
                    0xFF
                }
                (Some(&byte), _) if byte != 0xFF => {
                    self.position += 1;
                    byte
                }
                _ => {
                    self.lent = self.lent.saturating_add(8);
                    0
                }
            };
            self.held = self.held << 8 | u64::from(byte);
            self.count += 8;
        }
    }

    /// The next bits; no more than 32 after [`fill`](Self::fill).
    #[inline]
    pub const fn peek(&self, bits: u32) -> u32 {
        (self.held >> (self.count - bits)) as u32 & ((1_u64 << bits) - 1) as u32
    }

    #[inline]
    pub const fn skip(&mut self, bits: u32) {
        self.count -= bits;
    }

    /// Whether bits were used that are not there.
    pub const fn overdrawn(&self) -> bool {
        self.lent > self.count
    }

    /// Passes the restart marker with this number, and begins anew after it.
    pub fn restart(&mut self, number: u8) -> Result<(), CodecFault> {
        if self.overdrawn() {
            return Err(CodecFault::Truncated);
        }
        let found = self.data[self.position..].first_chunk::<2>();
        if found != Some(&[0xFF, 0xD0 | number & 7]) {
            return Err(if found.is_none() { CodecFault::Truncated } else { CodecFault::Corrupt });
        }
        *self = Self::new(self.data, self.position + 2);
        Ok(())
    }
}
