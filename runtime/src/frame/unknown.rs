//! Compile-time error messages for unknown names, built without allocation: the name, and the names most
//! similar to it.

/// Error message that a `const` function assembles at compile time.
pub struct Message {
    text: [u8; Message::CAPACITY],
    length: usize,
}

/// Maximum length of names whose edit distance is computed, bytes.
const LETTERS: usize = 64;
/// Maximum edit distance at which two names count as similar.
const EDITS: usize = 3;
/// Maximum number of existing names that the message lists.
const LISTED: usize = 8;

impl Message {
    const CAPACITY: usize = 1024;

    /// Returns the message that a mechanism has no frame of this name, with the most similar names, or all
    /// names if there are few.
    pub const fn unknown_frame(mechanism: &str, frames: &[&str], name: &str) -> Message {
        let start = Message::empty_message()
            .append_text("`")
            .append_text(mechanism)
            .append_text("` has no frame `")
            .append_text(name)
            .append_text("`");
        match start.append_nearest_names(frames, name) {
            (message, true) => message,
            (message, false) => message
                .append_text("; `")
                .append_text(mechanism)
                .append_text("::FRAMES` lists those that it has"),
        }
    }

    /// Returns the message that a list does not contain this name, with the most similar names, or all names
    /// if there are few.
    pub const fn message_for_unknown_name(list: &str, names: &[&str], name: &str) -> Message {
        let start = Message::empty_message()
            .append_text("`")
            .append_text(list)
            .append_text("` has no entry `")
            .append_text(name)
            .append_text("`");
        start.append_nearest_names(names, name).0
    }

    const fn empty_message() -> Message {
        Message { text: [0; Message::CAPACITY], length: 0 }
    }

    /// Appends the names most similar to `name` to the message, or all names if there are few. The flag is
    /// true if anything was appended.
    const fn append_nearest_names(self, names: &[&str], name: &str) -> (Message, bool) {
        let mut message = self;
        let mut first = true;
        let mut edits = 1;
        while edits <= EDITS + 1 {
            let mut k = 0;
            while k < names.len() {
                if edit_distance(names[k].as_bytes(), name.as_bytes()) == edits {
                    message = message
                        .append_text(if first { "; did you mean `" } else { "` or `" })
                        .append_text(names[k]);
                    first = false;
                }
                k += 1;
            }
            // Only names at the smallest distance are listed.
            edits = if first { edits + 1 } else { EDITS + 2 };
        }
        if !first {
            return (message.append_text("`?"), true);
        }
        if names.len() > LISTED {
            return (message, false);
        }
        let mut k = 0;
        while k < names.len() {
            message = message.append_text(if k == 0 { "; expected `" } else { "`, `" }).append_text(names[k]);
            k += 1;
        }
        (if names.is_empty() { message } else { message.append_text("`") }, true)
    }

    /// Returns the text of the message as a string.
    pub const fn text(&self) -> &str {
        // A message that is too long ends at the end of a piece.
        match core::str::from_utf8(self.text.split_at(self.length).0) {
            Ok(text) => text,
            Err(_) => "no frame has this name",
        }
    }

    const fn append_text(mut self, text: &str) -> Message {
        let text = text.as_bytes();
        if self.length + text.len() > Message::CAPACITY {
            return self;
        }
        let mut k = 0;
        while k < text.len() {
            self.text[self.length + k] = text[k];
            k += 1;
        }
        self.length += text.len();
        self
    }
}

/// Returns the edit distance of two names, ignoring case, if it is at most `EDITS` and a third of the length
/// of `b`. Otherwise returns `EDITS + 1` if one name contains the other, and `EDITS + 2` if not.
const fn edit_distance(a: &[u8], b: &[u8]) -> usize {
    let least = if a.len() < b.len() { a.len() } else { b.len() };
    let mut limit = b.len() / 3;
    limit = if limit > EDITS {
        EDITS
    } else if limit == 0 {
        1
    } else {
        limit
    };
    let far =
        if least >= 3 && (contains_bytes(a, b) || contains_bytes(b, a)) { EDITS + 1 } else { EDITS + 2 };
    if a.len() > LETTERS || b.len() > LETTERS || a.len().abs_diff(b.len()) > limit {
        return far;
    }
    // Rows of the Levenshtein table, restricted to the relevant band around its diagonal.
    let mut row = [EDITS + 1; LETTERS + 2];
    let mut j = 0;
    while j <= b.len() && j <= limit {
        row[j] = j;
        j += 1;
    }
    let mut i = 1;
    while i <= a.len() {
        let mut j = i.saturating_sub(limit);
        let mut before = if j == 0 { 0 } else { row[j - 1] };
        let mut left = EDITS + 1;
        if j == 0 {
            before = row[0];
            row[0] = i;
            left = i;
            j = 1;
        }
        while j <= b.len() && j <= i + limit {
            let above = row[j];
            let changed = before + !a[i - 1].eq_ignore_ascii_case(&b[j - 1]) as usize;
            let added = if above < left { above + 1 } else { left + 1 };
            left = if changed < added { changed } else { added };
            before = above;
            row[j] = left;
            j += 1;
        }
        i += 1;
    }
    match row[b.len()] {
        edits if edits <= limit && edits < b.len() => {
            if edits == 0 {
                1
            } else {
                edits
            }
        }
        _ => far,
    }
}

/// Whether the bytes `b` occur as a substring in `a`.
const fn contains_bytes(a: &[u8], b: &[u8]) -> bool {
    let mut start = 0;
    while start + b.len() <= a.len() {
        let mut k = 0;
        while k < b.len() && a[start + k] == b[k] {
            k += 1;
        }
        if k == b.len() {
            return true;
        }
        start += 1;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::string::ToString;

    fn unknown_frame_message(frames: &[&str], name: &str) -> std::string::String {
        Message::unknown_frame("Arm", frames, name).text().to_string()
    }

    #[test]
    fn message_lists_nearest_names() {
        let frames = ["base", "panda_link1", "panda_link2", "panda_hand", "tool"];
        assert_eq!(unknown_frame_message(&frames, "Tool"), "`Arm` has no frame `Tool`; did you mean `tool`?");
        assert_eq!(
            unknown_frame_message(&frames, "panda_lnik1"),
            "`Arm` has no frame `panda_lnik1`; did you mean `panda_link1`?"
        );
        assert_eq!(
            unknown_frame_message(&frames, "pandalink2"),
            "`Arm` has no frame `pandalink2`; did you mean `panda_link2`?"
        );
        assert_eq!(unknown_frame_message(&frames, "bas"), "`Arm` has no frame `bas`; did you mean `base`?");
        let two = "`Arm` has no frame `panda_link`; did you mean `panda_link1` or `panda_link2`?";
        assert_eq!(unknown_frame_message(&frames, "panda_link"), two);
        assert_eq!(
            unknown_frame_message(&frames, "hand"),
            "`Arm` has no frame `hand`; did you mean `panda_hand`?"
        );
        assert_eq!(
            unknown_frame_message(&["a", "b"], "elbow"),
            "`Arm` has no frame `elbow`; expected `a`, `b`"
        );
        assert_eq!(unknown_frame_message(&[], "elbow"), "`Arm` has no frame `elbow`");
        let many = ["a"; 9];
        assert_eq!(
            unknown_frame_message(&many, "elbow"),
            "`Arm` has no frame `elbow`; `Arm::FRAMES` lists those that it has"
        );
    }

    #[test]
    fn long_names_are_accepted() {
        let long = "ü".repeat(600);
        assert!(unknown_frame_message(&[&long, "a"], &long[..400]).starts_with("`Arm` has no frame"));
        assert!(unknown_frame_message(&[&long, &long], "a").starts_with("`Arm` has no frame `a`"));
    }
}
