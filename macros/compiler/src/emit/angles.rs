//! Sines and cosines. Those of all angles that depend only on inputs are evaluated at the start of a
//! function, several at a time.

use crate::lower::Angle;
use std::fmt::Write;

/// Number of SIMD lanes of the vectors in which a program with lanes evaluates angles.
pub const WIDTH: usize = 4;

/// Number of vectors of angles that one call evaluates together. The vectors share the constants and one test
/// for small angles, and all of them fit in registers.
const TOGETHER: usize = 4;

/// Calls of sines and cosines under construction: one call for all scalars, or calls for several vectors
/// each.
#[derive(Default)]
pub struct SineCosineCalls {
    /// Numbers of the program values that the calls of sine and cosine compute.
    pub names: Vec<usize>,
    /// Text of each computed value.
    results: Vec<String>,
    /// Text of each scalar or vector, and the numbers of the bindings of its results.
    arguments: Vec<(String, Vec<usize>)>,
    /// Scalars that do not fill a vector yet, with the numbers of their bindings.
    loose: Vec<(String, usize)>,
    /// True if angles are combined to SIMD vectors.
    in_vectors: bool,
    /// True if a call of scalars is padded to the width of vector registers.
    padded: bool,
    /// Number of variables bound so far.
    bound: usize,
}

impl SineCosineCalls {
    /// Returns an empty list of calls. `in_vectors` combines angles to vectors; `padded` pads a call of
    /// scalars to full registers.
    pub fn new(in_vectors: bool, padded: bool) -> SineCosineCalls {
        SineCosineCalls { in_vectors, padded, ..SineCosineCalls::default() }
    }

    /// Adds an angle to the calls, given by the texts of its lanes or the text of a whole vector.
    pub fn add_angle(&mut self, angle: &Angle, texts: Vec<String>, is_vector: bool) {
        let first = self.bound;
        self.bound += texts.len();
        for (value, letter) in [(angle.sine, 's'), (angle.cosine, 'c')] {
            let Some(value) = value else { continue };
            self.results.push(pattern_of_names(letter, &(first..self.bound).collect::<Vec<_>>()));
            self.names.push(value);
        }
        for (k, text) in texts.into_iter().enumerate() {
            match is_vector || !self.in_vectors {
                true => self.arguments.push((text, vec![first])),
                false => self.push_scalar_into_vector(text, first + k),
            }
        }
    }

    /// Adds a scalar to the incomplete vector, and completes the vector with its last lane.
    fn push_scalar_into_vector(&mut self, text: String, number: usize) {
        self.loose.push((text, number));
        if self.loose.len() == WIDTH {
            let (texts, numbers): (Vec<String>, Vec<usize>) = self.loose.drain(..).unzip();
            self.arguments.push((format!("Ops::lanes([{}])", texts.join(", ")), numbers));
        }
    }

    /// Returns the numbers of all values and the text of the tuple of their expressions.
    pub fn value_numbers_and_tuple_text(mut self, zero: &str) -> (Vec<usize>, String) {
        let mut text = String::from("{ ");
        if self.in_vectors {
            self.write_sine_cosine_vector_calls(&mut text, zero);
        } else if self.bound == 1 {
            let angles = self.arguments.iter().map(|(angle, _)| angle.as_str());
            let _ = write!(text, "let (s0, c0) = Ops::sin_cos({}); ", angles.collect::<String>());
        } else {
            self.write_scalar_angle_calls(&mut text);
        }
        let _ = write!(text, "({},) }}", self.results.join(", "));
        (self.names, text)
    }

    /// Writes a call of sine and cosine for every [`TOGETHER`] vectors.
    fn write_sine_cosine_vector_calls(&mut self, text: &mut String, zero: &str) {
        while !self.loose.is_empty() {
            self.bound += 1;
            self.push_scalar_into_vector(zero.to_string(), self.bound - 1);
        }
        for group in self.arguments.chunks(TOGETHER) {
            let list_vector_names = |letter| {
                let names: Vec<String> = group.iter().map(|(_, n)| format!("{letter}{}", n[0])).collect();
                names.join(", ")
            };
            let angles: Vec<&str> = group.iter().map(|(text, _)| text.as_str()).collect();
            let (sines, cosines, angles) =
                (list_vector_names('s'), list_vector_names('c'), angles.join(", "));
            let _ = write!(text, "let ([{sines}], [{cosines}]) = Ops::sin_cos_all([{angles}]); ");
            for (_, numbers) in group.iter().filter(|(_, numbers)| matches!(numbers.as_slice(), [_, _, ..])) {
                for letter in ['s', 'c'] {
                    let names: Vec<String> = numbers.iter().map(|k| format!("{letter}{k}")).collect();
                    let _ = write!(text, "let [{}] = {}.lanes().0; ", names.join(", "), names[0]);
                }
            }
        }
    }

    /// Writes one call for scalar angles, padded to full registers; for several states, one call for every
    /// [`TOGETHER`] angles.
    fn write_scalar_angle_calls(&mut self, text: &mut String) {
        if self.arguments.is_empty() {
            return;
        }
        if self.padded {
            self.pad_angles_to_registers();
        }
        let together = if self.padded { self.arguments.len() } else { TOGETHER };
        for group in self.arguments.chunks(together) {
            let join_name_patterns = |letter| {
                group.iter().map(|(_, n)| pattern_of_names(letter, n)).collect::<Vec<_>>().join(", ")
            };
            let angles: Vec<&str> = group.iter().map(|(text, _)| text.as_str()).collect();
            let (sines, cosines, angles) =
                (join_name_patterns('s'), join_name_patterns('c'), angles.join(", "));
            let _ = write!(text, "let ([{sines}], [{cosines}]) = Ops::sin_cos_all([{angles}]); ");
        }
    }

    /// Pads the angles to full registers by repeating some of them, so that each register is one load from
    /// memory if the angles are adjacent.
    fn pad_angles_to_registers(&mut self) {
        let count = self.arguments.len();
        let repeated_argument = |list: &[(String, Vec<usize>)], k: usize| (list[k].0.clone(), Vec::new());
        match count % WIDTH {
            0 => {}
            // Repeats the angle before the last three.
            3 if count > WIDTH => {
                self.arguments.insert(count - 3, repeated_argument(&self.arguments, count - 4))
            }
            3 => self.arguments.push(repeated_argument(&self.arguments, count - 1)),
            rest => (rest..WIDTH).for_each(|k| {
                let k = count - rest + k % rest;
                self.arguments.push(repeated_argument(&self.arguments, k));
            }),
        }
        let count = self.arguments.len();
        if count > WIDTH && !count.is_multiple_of(2 * WIDTH) {
            (count - WIDTH..count).for_each(|k| self.arguments.push(repeated_argument(&self.arguments, k)));
        }
    }
}

/// Returns one name, an array of several names, or `_` for no name.
fn pattern_of_names(letter: char, numbers: &[usize]) -> String {
    let names: Vec<String> = numbers.iter().map(|k| format!("{letter}{k}")).collect();
    match names.as_slice() {
        [] => "_".to_string(),
        [one] => one.clone(),
        names => format!("Ops::lanes([{}])", names.join(", ")),
    }
}
