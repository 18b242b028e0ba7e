//! RLE Lossless (DICOM PS3.5 annex G); the DICOM library reads it but does not write it.

/// The high bytes and the low bytes of all pixels.
pub(super) fn planes(pixels: &[u16]) -> [Vec<u8>; 2] {
    let of = |byte: fn(u16) -> u8| pixels.iter().map(|&value| byte(value)).collect();
    [of(|value| (value >> 8) as u8), of(|value| value as u8)]
}

/// One frame: a header of sixteen words, then the planes, each with one byte per pixel, packed row by row.
pub(super) fn encode(planes: &[Vec<u8>], columns: usize) -> Vec<u8> {
    const HEADER_BYTES: usize = 64;
    let mut frame = vec![0; HEADER_BYTES];
    let mut header = [0_u32; 16];
    header[0] = planes.len() as u32;
    for (number, plane) in planes.iter().enumerate() {
        header[1 + number] = frame.len() as u32;
        plane.chunks(columns.max(1)).for_each(|row| pack(row, &mut frame));
        if frame.len() % 2 == 1 {
            frame.push(0);
        }
    }
    for (place, word) in frame.chunks_exact_mut(4).zip(header) {
        place.copy_from_slice(&word.to_le_bytes());
    }
    frame
}

/// Runs of three or more equal bytes as a count and a byte, everything else as a count and the bytes themselves.
fn pack(bytes: &[u8], out: &mut Vec<u8>) {
    const MAX_RUN: usize = 128;
    let run = |from: usize| {
        bytes[from..].iter().take(MAX_RUN).take_while(|&&byte| byte == bytes[from]).count()
    };
    let mut at = 0;
    while at < bytes.len() {
        let equal = run(at);
        if equal >= 3 {
            // -(count - 1) as a signed byte.
            out.extend([(257 - equal) as u8, bytes[at]]);
            at += equal;
            continue;
        }
        let start = at;
        while at < bytes.len() && at - start < MAX_RUN && run_below_three(&bytes[at..]) {
            at += 1;
        }
        out.push((at - start - 1) as u8);
        out.extend(&bytes[start..at]);
    }
}

/// Whether fewer than three equal bytes begin here.
fn run_below_three(bytes: &[u8]) -> bool {
    !matches!(bytes, [a, b, c, ..] if a == b && b == c)
}

#[cfg(test)]
mod tests {
    use super::pack;

    /// Packed and unpacked bytes of the description in PS3.5 G.3.1.
    #[test]
    fn runs_and_literals_are_packed_as_in_the_standard() {
        let packed = |bytes: &[u8]| {
            let mut out = Vec::new();
            pack(bytes, &mut out);
            out
        };
        assert_eq!(packed(&[7; 5]), [252, 7]);
        assert_eq!(packed(&[1, 2, 3]), [2, 1, 2, 3]);
        assert_eq!(packed(&[1, 1, 2, 2, 2, 2]), [1, 1, 1, 253, 2]);
        assert_eq!(packed(&[9; 129]), [129, 9, 0, 9]);
        assert_eq!(packed(&[]), [0_u8; 0]);
    }
}
