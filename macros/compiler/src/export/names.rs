//! Conversion of the user's names to C identifiers.

/// Keywords of C and C++, and macros of headers and compilers, separated by spaces.
const RESERVED: &str = "\
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char class compl complex \
    concept const consteval constexpr constinit const_cast continue co_await co_return co_yield \
    decltype default delete do double dynamic_cast else enum errno explicit export extern false float \
    for fortran friend goto i386 if imaginary inline int linux long mutable namespace near far new \
    noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast \
    requires restrict return short signed sizeof static static_assert static_cast struct switch \
    template this thread_local throw true try typedef typeid typename typeof union unix unsigned using \
    virtual void volatile wchar_t while xor xor_eq math_errhandling";

/// Names of functions and macros in the included headers, except those that the generated code calls,
/// separated by spaces.
const OF_HEADERS: &str = "\
    abs acosh asinh atanh bcmp bcopy bzero canonicalize casadi_int casadi_real cbrt ceil clock daddl \
    div drem erf erfc exp10 exp2 explicit_bzero expm1 fdim ffs ffsl ffsll finite floor fmaxmag fminmag \
    fmod fpclassify frexp fromfp gamma hypot ilogb index iseqsig isfinite isgreater isgreaterequal \
    isinf isless islessequal islessgreater isnan isnormal isunordered j0 j1 jn ldexp lgamma lgamma_r \
    lgammaf_r lgammal_r llogb llrint llround log10 log1p log2 logb lrint lround memccpy memchr memcmp \
    memcpy memmove memset modf nan nearbyint nextafter nextdown nexttoward nextup pow10 remainder \
    remquo rindex rint round roundeven scalb scalbln scalbn setpayload signbit signgam significand \
    sincos stpcpy stpncpy strcasecmp strcat strchr strcmp strcoll strcpy strcspn strdup strerror \
    strerror_r strlen strncasecmp strncat strncmp strncpy strndup strnlen strpbrk strrchr strsep \
    strsignal strspn strstr strtok strtok_r strxfrm tgamma time totalorder trunc ufromfp y0 y1 yn";

/// Returns true if a list of names, separated by spaces, contains a name.
fn list_contains_name(list: &str, name: &str) -> bool {
    list.split_whitespace().any(|known| known == name)
}

/// Replaces characters that are invalid in identifiers: ASCII punctuation by underscores, other characters by
/// their Unicode numbers.
pub fn replace_invalid_characters(name: &str) -> String {
    let mut text = String::new();
    for c in name.trim_start_matches("r#").chars() {
        match c {
            c if c.is_ascii_alphanumeric() => text.push(c),
            c if c.is_ascii() => text.push('_'),
            c => text.push_str(&format!("u{:04x}", u32::from(c))),
        }
    }
    text
}

/// Converts a name to an identifier. Keywords and names in capitals (most macros are) get a trailing
/// underscore; names that begin with a digit or an underscore get a leading letter.
pub fn identifier_from_name(name: &str) -> String {
    let mut text = replace_invalid_characters(name);
    if text.starts_with(|c: char| !c.is_ascii_alphabetic()) {
        text.insert(0, 'x');
    }
    let shouts = text.len() > 2 && text.chars().all(|c| !c.is_ascii_lowercase());
    if shouts || list_contains_name(RESERVED, &text) {
        text.push('_');
    }
    text
}

/// Returns the prefix of all names of a mechanism, which is also the name of a type. The prefix differs from
/// all names in headers, and no name of the mechanism begins with `lw_`, the prefix of helpers.
pub fn c_name_prefix(name: &str) -> String {
    let mut text = identifier_from_name(name);
    if text == "lw" || text.starts_with("lw_") {
        text.insert(0, 'x');
    }
    let is_of_header =
        |name: &str| list_contains_name(OF_HEADERS, name) || super::tokens::FUNCTIONS.contains(&name);
    // The mathematical library has each function in three precisions, and type names have these endings.
    let plain = text.strip_suffix(['f', 'l']).unwrap_or(&text);
    if is_of_header(&text) || is_of_header(plain) || text.ends_with("_t") || text.ends_with("_l") {
        text.push('_');
    }
    text
}

/// Returns C identifiers for several names that are unique in one scope.
pub fn unique_identifiers<S: AsRef<str>>(names: &[S]) -> Vec<String> {
    make_names_unique(names.iter().map(|name| identifier_from_name(name.as_ref())))
}

/// Returns names in capitals, unique among each other, as ends of C constants. The caller writes a common
/// prefix before them.
pub fn unique_constant_suffixes<S: AsRef<str>>(names: &[S]) -> Vec<String> {
    make_names_unique(names.iter().map(|name| replace_invalid_characters(name.as_ref()).to_ascii_uppercase()))
}

fn make_names_unique(all: impl Iterator<Item = String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for name in all {
        let mut text = name.clone();
        let mut number = 2_usize;
        while found.contains(&text) {
            text = format!("{name}_{number}");
            number += 1;
        }
        found.push(text);
    }
    found
}

/// Converts a type name to lower case with underscores between words.
pub fn to_snake_case(name: &str) -> String {
    let mut text = String::new();
    let mut before: Option<char> = None;
    let mut rest = name.trim_start_matches("r#").chars().peekable();
    while let Some(c) = rest.next() {
        let after_small = before.is_some_and(|b| b.is_lowercase() || b.is_ascii_digit());
        let begins_word =
            before.is_some_and(char::is_uppercase) && rest.peek().is_some_and(|n| n.is_lowercase());
        if c.is_uppercase() && (after_small || begins_word) {
            text.push('_');
        }
        text.extend(c.to_lowercase());
        before = Some(c);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reserved_c_names_are_replaced() {
        assert_eq!(
            ["mass", "r#type", "int", "class", "2nd", "_x", "µ", "NAN", "M_PI", "L", "left-arm"]
                .map(identifier_from_name),
            ["mass", "type", "int_", "class_", "x2nd", "x_x", "u00b5", "NAN_", "M_PI_", "L", "left_arm"]
        );
        assert_eq!(unique_identifiers(&["a-b", "a_b", "a b"]), ["a_b", "a_b_2", "a_b_3"]);
        assert_eq!(unique_constant_suffixes(&["tool", "r#in", "left-arm"]), ["TOOL", "IN", "LEFT_ARM"]);
        assert_eq!(
            ["CartPole", "UR5", "Solo12", "HTTPServer"].map(to_snake_case),
            ["cart_pole", "ur5", "solo12", "http_server"]
        );
    }
}
