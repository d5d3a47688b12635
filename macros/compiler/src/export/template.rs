//! Templates of exported code: text with placeholders `@NAME@`, and lines between `#if NAME` and `#endif`
//! that exist only under a condition.

/// Values and conditions with which templates are filled.
#[derive(Clone, Default)]
pub struct TemplateValues {
    values: Vec<(String, String)>,
    conditions: Vec<(&'static str, bool)>,
}

impl TemplateValues {
    /// Adds the value of the placeholder `@NAME@`. Values may contain placeholders that are added later.
    pub fn add_value(&mut self, name: &str, value: &dyn ToString) {
        self.values.push((format!("@{name}@"), value.to_string()));
    }

    /// Adds the condition of lines after `#if NAME` and `#if !NAME`.
    pub fn add_condition(&mut self, name: &'static str, holds: bool) {
        self.conditions.push((name, holds));
    }

    /// Returns a text with the values of all placeholders, and the lines whose conditions hold. Other
    /// conditions of the preprocessor do not change.
    pub fn fill(&self, template: &str) -> String {
        // For each open `#if`: whether its lines exist, if it has a condition of the template.
        let mut open: Vec<Option<bool>> = Vec::new();
        let mut text = String::with_capacity(template.len());
        for line in template.lines() {
            if line.starts_with("#if") {
                open.push(line.strip_prefix("#if ").and_then(|name| self.condition_value(name)));
            } else if let ("#else", Some(Some(holds))) = (line, open.last_mut()) {
                *holds = !*holds;
                continue;
            } else if line.starts_with("#endif") && open.pop().flatten().is_some() {
                continue;
            }
            let is_marker = line.starts_with("#if") && open.last().is_some_and(Option::is_some);
            if !is_marker && open.iter().all(|holds| holds.unwrap_or(true)) {
                text.push_str(line);
                text.push('\n');
            }
        }
        self.values.iter().fold(text, |text, (name, value)| text.replace(name, value))
    }

    /// Returns whether a condition holds; `None` if the template does not define it.
    fn condition_value(&self, name: &str) -> Option<bool> {
        let (plain, wanted) = name.strip_prefix('!').map_or((name, true), |plain| (plain, false));
        let known = self.conditions.iter().find(|(known, _)| *known == plain);
        known.map(|(_, holds)| *holds == wanted)
    }
}

#[cfg(test)]
mod tests {
    use super::TemplateValues;

    #[test]
    fn conditions_select_lines_and_values_replace_placeholders() {
        let mut template = TemplateValues::default();
        template.add_value("N", &3);
        template.add_condition("SPEEDS", true);
        template.add_condition("TIME", false);
        let text = "a @N@\n#if SPEEDS\nb\n#if TIME\nc\n#else\nd\n#endif\n#else\ne\n#endif\n#ifdef SPEEDS\nf\n\
                    #else\ng\n#endif\n#if !TIME\nh\n#endif\n";
        assert_eq!(template.fill(text), "a 3\nb\nd\n#ifdef SPEEDS\nf\n#else\ng\n#endif\nh\n");
    }
}
