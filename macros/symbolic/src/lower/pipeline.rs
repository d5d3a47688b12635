//! Ordered lists of the passes over a program. An observer can inspect the program after each pass.

use super::Program;
use std::cell::RefCell;
use std::time::{Duration, Instant};

/// A pass over a program and over its SIMD variant.
#[derive(Clone, Copy)]
pub struct Pass {
    /// Name of the pass over programs.
    pub name: &'static str,
    /// Description of the pass over programs, in one clause.
    pub about: &'static str,
    run: fn(Program) -> Program,
}

/// Name of the translation from expressions to instructions, which is observed like a pass.
pub const SELECT: &str = "select";

const FACTOR: Pass = Pass {
    name: "factor",
    about: "common factors of the terms of a sum are taken out",
    run: Program::factor_sums,
};
const NEGATIONS: Pass = Pass {
    name: "negations",
    about: "the negatives of some values are computed, so that few negations are left",
    run: Program::choose_signs_with_fewest_negations,
};
const CHAIN: Pass = Pass {
    name: "chain",
    about: "sums begin with a product, so that more products fuse",
    run: Program::order_terms_for_fusion,
};
const SHARE_SUBSUMS: Pass = Pass {
    name: "share-subsums",
    about: "terms that several sums have in common are summed once",
    run: Program::with_shared_sums,
};
const REASSOCIATE: Pass = Pass {
    name: "reassociate",
    about: "in sums on the longest chain, operands that are available late are added last",
    run: Program::with_late_terms_last,
};
const FUSE: Pass = Pass {
    name: "fuse",
    about: "a product whose only use is a sum becomes one instruction with it",
    run: Program::with_fused_products,
};
/// Pass that orders the instructions.
pub const SCHEDULE: Pass = Pass {
    name: "schedule",
    about: "instructions are put in an order that keeps the processor busy",
    run: Program::schedule_instructions,
};

/// Passes over every candidate program of a function, before its operations are counted.
pub const DRAFT: &[Pass] = &[FACTOR, NEGATIONS, CHAIN];
/// Passes that run, in this order, on the cheapest candidate program of a function.
pub const FINISH: &[Pass] = &[SHARE_SUBSUMS, REASSOCIATE, FUSE, SCHEDULE];
/// Passes over short programs: a transformation from link to link, or the values of a prepared mechanism.
pub const PART: &[Pass] = &[FUSE];

impl Program {
    /// Runs passes over the program and its SIMD variant.
    #[must_use]
    pub fn run_passes(mut self, passes: &[Pass]) -> Program {
        let simd = self.simd.take().map(|program| Box::new(program.run_passes(passes)));
        for pass in passes {
            let start = Instant::now();
            self = (pass.run)(self);
            report_to_observer(pass.name, &self, start.elapsed());
        }
        Program { simd, ..self }
    }
}

/// Callback after every pass: the function that is being compiled, the name of the pass, the program, and the
/// duration.
type PassObserver = Box<dyn FnMut(&str, &str, &Program, Duration)>;

thread_local! {
    static OBSERVER: RefCell<Option<PassObserver>> = const { RefCell::new(None) };
    static FUNCTION: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Calls `f` with an observer of all passes on this thread.
pub fn run_with_pass_observer<T>(observer: PassObserver, f: impl FnOnce() -> T) -> T {
    OBSERVER.with(|cell| cell.replace(Some(observer)));
    let result = f();
    OBSERVER.with(|cell| cell.replace(None));
    result
}

/// Sets the name of the function that the next passes belong to.
pub fn set_observed_function_name(function: &str) {
    if OBSERVER.with(|cell| cell.borrow().is_some()) {
        FUNCTION.with(|name| name.replace(function.to_string()));
    }
}

/// Reports a pass to the observer of passes, if there is one.
pub(super) fn report_to_observer(pass: &str, program: &Program, time: Duration) {
    OBSERVER.with(|cell| {
        if let Ok(mut observer) = cell.try_borrow_mut()
            && let Some(observer) = observer.as_mut()
        {
            FUNCTION.with(|function| observer(&function.borrow(), pass, program, time));
        }
    });
}

#[cfg(test)]
mod tests;
