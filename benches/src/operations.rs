//! Numbers of operations of generated functions, as counted by the compiler.

use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::lower::Program;
use linkwork_compiler::{compile, parse_source_and_import};
use proc_macro2::TokenStream;
use std::path::Path;

/// Size of one generated function: operations, and calls of elementary functions.
#[derive(Clone, Copy, Debug, Default)]
pub struct FunctionOperationCounts {
    /// Number of multiplications, additions and divisions.
    pub operations: usize,
    /// Number of operations if each product and its sum count as one instruction.
    pub fused: usize,
    /// Number of calls of elementary functions.
    pub calls: usize,
}

impl FunctionOperationCounts {
    fn sum_over_programs<'a>(programs: impl IntoIterator<Item = &'a Program>) -> FunctionOperationCounts {
        let mut size = FunctionOperationCounts::default();
        for program in programs {
            size.operations += program.counts.total_operations();
            size.fused += program.instructions.len() - program.counts.calls;
            size.calls += program.counts.calls;
        }
        size
    }
}

/// Output of the compiler for a mechanism, whose operations are counted.
pub struct CompiledMechanism {
    output: DerivationOutput,
    /// Number of nodes of the mechanism's expression graph.
    pub nodes: usize,
    /// Number of velocities of the mechanism.
    pub velocities: usize,
}

impl CompiledMechanism {
    /// Compiles `#[mechanism(arguments)] item`; paths are relative to this package. Panics if the mechanism
    /// has an error.
    pub fn compile_mechanism(arguments: &str, item: &str) -> CompiledMechanism {
        let parse_tokens = |text: &str| -> TokenStream { text.parse().expect("tokens") };
        let cx = &mut Diagnostics::new();
        let graph = Graph::new();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
        let found = parse_source_and_import(parse_tokens(arguments), parse_tokens(item), folder, cx);
        let found = found.and_then(|source| compile(&source, &graph, cx));
        let Some((model, output)) = found else {
            panic!("{}", cx.full_message_texts().join("\n"));
        };
        CompiledMechanism { output, nodes: graph.len(), velocities: model.nv() }
    }

    /// Returns the numbers of operations of a generated function; zero if it does not exist.
    pub fn operation_counts_of_function(&self, name: &str) -> FunctionOperationCounts {
        let found = self.output.functions.iter().filter(|f| f.name == name);
        FunctionOperationCounts::sum_over_programs(found.map(|f| &f.program))
    }

    /// Returns the numbers of operations of a frame's Jacobian: the steps along the path to its link.
    pub fn jacobian_operation_counts(&self, frame: &str) -> FunctionOperationCounts {
        let frame = self.output.frames.iter().find(|f| f.name == frame);
        let mut programs: Vec<&Program> = frame.map(|f| &f.placement).into_iter().collect();
        let mut at = frame.and_then(|f| f.link);
        while let Some(k) = at {
            let link = &self.output.links[k];
            programs.extend([&link.placement, &link.columns]);
            at = link.parent;
        }
        FunctionOperationCounts::sum_over_programs(programs)
    }
}
