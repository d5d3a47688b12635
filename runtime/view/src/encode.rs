//! Encoding of samples as text: values are quantised, successive differences are written as variable-length
//! integers, and the bytes are encoded in base64.
//!
//! A channel consists of its first value, then 0 if it is constant, or 1 and the differences. Integers are
//! written with seven bits per byte, lowest first, with the sign in the lowest bit.

/// Binary data of several concatenated channels, such as the coordinates of a motion.
#[derive(Default)]
pub struct Stream {
    bytes: Vec<u8>,
}

/// Maximum magnitude of a quantised value: three quarters of the range of 31 bits.
const LARGEST: f64 = 1.5e9;

impl Stream {
    /// Appends a channel, quantised in multiples of `quantum`.
    pub fn channel(&mut self, values: impl Iterator<Item = f64>, quantum: f64) {
        let steps: Vec<i64> = values.map(|x| quantised_integer(x / quantum)).collect();
        let Some(first) = steps.first() else { return };
        self.write_integer(*first);
        let moves = steps.iter().any(|step| step != first);
        self.write_integer(i64::from(moves));
        if moves {
            steps.windows(2).for_each(|pair| self.write_integer(pair[1] - pair[0]));
        }
    }

    fn write_integer(&mut self, n: i64) {
        let mut rest = ((n << 1) ^ (n >> 63)).cast_unsigned();
        while rest >= 0x80 {
            self.bytes.push((rest & 0x7f) as u8 | 0x80);
            rest >>= 7;
        }
        self.bytes.push(rest as u8);
    }

    /// Returns the data of all channels in base64.
    pub fn text(&self) -> String {
        base64(&self.bytes)
    }
}

fn quantised_integer(x: f64) -> i64 {
    x.round().clamp(-LARGEST, LARGEST) as i64
}

/// Encodes bytes in base64 with padding (RFC 4648).
pub fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte_of_group = |k: usize| u32::from(group.get(k).copied().unwrap_or(0));
        let word = byte_of_group(0) << 16 | byte_of_group(1) << 8 | byte_of_group(2);
        for k in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * k) & 63) as usize];
            out.push(if k <= group.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the base64 examples of RFC 4648, section 10.
    #[test]
    fn base64_matches_rfc_examples() {
        let known = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (text, encoded) in known {
            assert_eq!(base64(text.as_bytes()), encoded);
        }
    }

    #[test]
    fn integers_use_seven_bits_per_byte() {
        let mut stream = Stream::default();
        [0, -1, 1, 63, -64, 64, 300].into_iter().for_each(|n| stream.write_integer(n));
        assert_eq!(stream.bytes, [0, 1, 2, 126, 127, 128, 1, 216, 4]);
    }

    #[test]
    fn constant_channel_takes_two_integers() {
        let mut stream = Stream::default();
        stream.channel([0.25; 100].into_iter(), 0.5);
        assert_eq!(stream.bytes, [2, 0]);
    }
}
