//! Detection of a `#[derive(…)]` above the attribute: it has already seen the struct with its elements. The
//! attribute cannot detect this from its tokens, so the source file is searched.

/// Returns true if an attribute, which begins at the given line and column (counted from one), comes after a
/// `#[derive(…)]` of the same item.
pub fn stands_below_a_derive(text: &str, line: usize, column: usize) -> bool {
    let lines: Vec<&str> = text.lines().take(line).collect();
    let Some((own, above)) = lines.split_last() else { return false };
    // In tests of documentation, lines are those of the comment, not of the text.
    let (own, attribute): (String, String) = {
        let column = column.saturating_sub(1);
        (own.chars().take(column).collect(), own.chars().skip(column).collect())
    };
    if !attribute.starts_with("#[") {
        return false;
    }
    for line in [own.as_str()].into_iter().chain(above.iter().rev().copied()).map(str::trim) {
        if line.starts_with("#[derive(") {
            return true;
        }
        // End of another item.
        let code = line.split("//").next().unwrap_or_default().trim_end();
        if [";", "}", "{", "*/"].iter().any(|end| code.ends_with(end)) {
            return false;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::stands_below_a_derive;

    #[test]
    fn derive_above_the_attribute_is_found() {
        let below = ["#[derive(Clone)]\n", "#[derive(\n    Clone,\n)]\n/// A cart.\n\n", "#[derive(Clone)] "];
        for above in below {
            let text = format!("use a::b;\n{above}#[mechanism]\nstruct Cart;");
            let line = text.lines().position(|line| line.contains("#[mechanism]")).unwrap_or_default() + 1;
            let column = text.lines().nth(line - 1).and_then(|l| l.find("#[m")).unwrap_or_default() + 1;
            assert!(stands_below_a_derive(&text, line, column), "{text}");
        }
    }

    #[test]
    fn derive_of_another_item_is_ignored() {
        for above in [
            "#[derive(Clone)]\nstruct A;\n",
            "#[derive(Clone)]\nstruct A { a: f64 } // end\n",
            "/// A `cart`\n",
        ] {
            let text = format!("{above}#[mechanism]\n#[derive(Clone)]\nstruct Cart;");
            let line = text.lines().position(|line| line.contains("#[mechanism]")).unwrap_or_default() + 1;
            assert!(!stands_below_a_derive(&text, line, 1), "{text}");
        }
        assert!(!stands_below_a_derive("", 1, 1));
        assert!(!stands_below_a_derive("#[derive(Clone)]\n/// #[mechanism]", 2, 1));
    }
}
