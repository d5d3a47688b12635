//! Decoder of the data in pages, independent of the decoder `view.js` in the browser.

use serde_json::Value;

/// Returns the motions in the JSON data of a page.
pub fn motions(page: &str) -> Vec<Value> {
    let begin = "<script type=\"application/json\">";
    let (_, rest) = page.split_once(begin).unwrap();
    let (data, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(data).unwrap()
}

/// Returns the channels of a motion: times, then for each frame three positions and four entries of a
/// quaternion, then curves.
pub fn channels(motion: &Value) -> Vec<Vec<i64>> {
    let bytes = decode_base64(motion["data"].as_str().unwrap());
    let count = motion["count"].as_u64().unwrap() as usize;
    let mut at = 0;
    let mut channels = Vec::new();
    while at < bytes.len() {
        let mut decode_integer = || {
            let (mut n, mut shift) = (0_u64, 0);
            loop {
                n |= u64::from(bytes[at] & 0x7f) << shift;
                at += 1;
                if bytes[at - 1] < 0x80 {
                    return if n % 2 == 0 { (n / 2) as i64 } else { -((n / 2) as i64) - 1 };
                }
                shift += 7;
            }
        };
        let mut value = decode_integer();
        let changes = decode_integer() == 1;
        let mut channel = vec![value];
        for _ in 1..count {
            value += if changes { decode_integer() } else { 0 };
            channel.push(value);
        }
        channels.push(channel);
    }
    channels
}

fn decode_base64(text: &str) -> Vec<u8> {
    let base64_digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let digits: Vec<u32> = text.bytes().filter(|c| *c != b'=').map(|c| u32::from(base64_digit(c))).collect();
    let bytes_of_base64_group = |g: &[u32]| {
        let word = g.iter().enumerate().fold(0, |word, (k, d)| word | d << (18 - 6 * k));
        word.to_be_bytes()[1..g.len()].to_vec()
    };
    digits.chunks(4).flat_map(bytes_of_base64_group).collect()
}
