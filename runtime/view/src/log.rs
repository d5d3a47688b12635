//! Logs of motions as comma-separated values (RFC 4180).

use crate::Error;
use crate::figure::to_double;
use crate::motion::check_times;
use linkwork::simulate::Sample;
use linkwork::{Mechanism, Real};
use std::fmt::{Display, Write};

/// Writes a motion as comma-separated values: a line of names, then one line per sample with time, s,
/// configuration, velocity and inputs, all in full precision.
///
/// The columns are `t`, then the names of `CONFIGURATION`, `VELOCITIES` and `INPUTS` with the prefixes `q.`,
/// `v.` and `u.`. Names with commas, quotes or line breaks are quoted.
///
/// ```
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y)]
/// struct Pendulum {
///     #[particle(mass = 1)]
///     bob: Particle,
///     #[joint(ground -> bob.at(y), about = z)]
///     hinge: Pin,
/// }
///
/// let fall: Vec<_> = simulate(&Pendulum {}).from([0.5], [0.0]).duration(0.1).sample_every(0.05).collect::<Result<_, _>>()?;
/// let log = linkwork_view::csv(&Pendulum {}, &fall)?;
/// assert!(log.starts_with("t,q.hinge,v.hinge\r\n0,0.5,0\r\n0.05,"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`Error::Empty`] without samples, [`Error::Time`] if a time is not finite or before the previous one, as
/// for [`page`](crate::page). Other values may be infinite or NaN, so that the log shows where a motion
/// fails.
pub fn csv<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    _mechanism: &M,
    samples: &[Sample<T, NQ, NV, NU>],
) -> Result<String, Error>
where
    T: Real + Display,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
{
    check_times("csv", samples.iter().map(|sample| to_double(sample.t)))?;
    let prefixed_names = |list: &[&str], of: &str| {
        list.iter().map(|name| quoted_field(&format!("{of}.{name}"))).collect::<Vec<_>>()
    };
    let head = [
        prefixed_names(&M::CONFIGURATION, "q"),
        prefixed_names(&M::VELOCITIES, "v"),
        prefixed_names(&M::INPUTS, "u"),
    ]
    .concat();
    let mut out = "t".to_string();
    head.iter().for_each(|name| out.extend([",", name]));
    out.push_str("\r\n");
    for sample in samples {
        let _ = write!(out, "{}", sample.t);
        for x in sample.q.iter().chain(&sample.v).chain(&sample.u) {
            let _ = write!(out, ",{x}");
        }
        out.push_str("\r\n");
    }
    Ok(out)
}

/// Returns a field of a CSV file, in quotes if it contains commas, quotes or line breaks.
fn quoted_field(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::quoted_field;

    #[test]
    fn csv_names_with_commas_are_quoted() {
        assert_eq!(quoted_field("q.hinge"), "q.hinge");
        assert_eq!(quoted_field("a,\"b\"\n"), "\"a,\"\"b\"\"\n\"");
    }
}
