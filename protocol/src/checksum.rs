//! CRC-32 as of Ethernet and zip (IEEE 802.3): polynomial 0x04C11DB7, bits reversed, begun and ended with all
//! ones.

const REVERSED: u32 = 0xEDB8_8320;

/// The remainder of every byte.
const REMAINDERS: [u32; 256] = {
    let mut remainders = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut remainder, mut bit) = (byte as u32, 0);
        while bit < 8 {
            remainder = (remainder >> 1) ^ (if remainder & 1 == 1 { REVERSED } else { 0 });
            bit += 1;
        }
        remainders[byte] = remainder;
        byte += 1;
    }
    remainders
};

/// The checksum of bytes that come one after the other.
#[derive(Debug)]
pub(crate) struct Crc(u32);

impl Crc {
    /// Of none yet.
    pub(crate) fn new() -> Crc {
        Crc(!0)
    }

    /// More bytes.
    pub(crate) fn add(&mut self, bytes: &[u8]) {
        self.0 =
            bytes.iter().fold(self.0, |sum, byte| (sum >> 8) ^ REMAINDERS[usize::from(sum as u8 ^ byte)]);
    }

    /// Of all so far.
    pub(crate) fn sum(&self) -> u32 {
        !self.0
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Crc;

    fn crc32(bytes: &[u8]) -> u32 {
        let mut crc = Crc::new();
        crc.add(bytes);
        crc.sum()
    }

    /// The check value of the catalogue of CRCs.
    #[test]
    fn nine_digits() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    proptest! {
        #[test]
        fn it_is_that_of_another_library(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            prop_assert_eq!(crc32(&bytes), crc32fast::hash(&bytes));
        }
    }
}
