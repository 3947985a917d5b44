//! The seal of a message: a sum over everything else in it, by which a receiver sees that it was damaged on
//! its way. Every control cycle has a dozen of them, so it is a sum of words of eight bytes in four lanes,
//! which a processor adds side by side.
//!
//! Each word goes into a product that no other value of it gives, so one damaged word is always another sum
//! of 64 bits; its halves are folded.

/// Odd, with its bits well mixed: 2⁶⁴ over the golden ratio.
const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
const LANES: usize = 4;

/// The sum of bytes, whole words of them, without the upper half of the word `at`, where the seal itself is.
pub(crate) fn seal(bytes: &[u8], at: usize) -> u32 {
    let mut lanes = [0u64; LANES];
    let whole = |word: &[u8]| word.try_into().map_or(0, u64::from_le_bytes);
    for (row, words) in bytes.chunks(8 * LANES).enumerate() {
        for (lane, word) in words.chunks_exact(8).enumerate() {
            let word = if row * LANES + lane == at { whole(word) & 0xFFFF_FFFF } else { whole(word) };
            lanes[lane] = (lanes[lane] ^ word).wrapping_mul(ODD).rotate_left(29);
        }
    }
    let sum = lanes.iter().fold(0u64, |sum, lane| (sum ^ lane).wrapping_mul(ODD).rotate_left(29));
    (sum >> 32) as u32 ^ sum as u32
}

#[cfg(test)]
mod tests {
    use super::seal;

    #[test]
    fn every_bit_counts_but_those_of_the_seal() {
        let bytes: Vec<u8> = (0..80u8).map(|i| i.wrapping_mul(37)).collect();
        let sum = seal(&bytes, 3);
        for bit in 0..8 * bytes.len() {
            let mut other = bytes.clone();
            other[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(seal(&other, 3) == sum, (28..32).contains(&(bit / 8)), "bit {bit}");
        }
    }
}
