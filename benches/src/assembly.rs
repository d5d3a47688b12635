//! Parser for assembly files in the AT&T syntax that rustc writes for x86-64. It determines the size of each
//! function, its stack and the functions that it calls, and supports only the syntax that this needs.

use rustc_demangle::demangle;
use std::collections::{BTreeMap, BTreeSet};

/// Function of an assembly file: its size, its stack frame and its calls.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Routine {
    /// Number of instructions of the function, without padding.
    pub instructions: usize,
    /// Size of the stack frame of the function itself, bytes.
    pub stack: usize,
    /// Linker names of the functions that this function calls or jumps to.
    pub calls: BTreeSet<String>,
    /// Whether this function calls an address that it has computed or read from memory.
    pub calls_by_address: bool,
}

/// Parses an assembly file and returns all functions by their linker names.
#[must_use]
pub fn parse_routines(text: &str) -> BTreeMap<String, Routine> {
    let mut found = BTreeMap::new();
    let (mut names, mut routine) = (BTreeSet::new(), None);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("\t.type\t").and_then(|rest| rest.strip_suffix(",@function")) {
            names.insert(name);
        } else if let Some(name) = line.strip_suffix(':').filter(|name| names.contains(name)) {
            routine = Some((name, RoutineReader::default()));
        } else if line.starts_with("\t.size\t")
            && let Some((name, reader)) = routine.take()
        {
            found.insert(name.to_string(), reader.routine);
        } else if let Some((_, reader)) = &mut routine
            && let Some(instruction) = instruction_of_line(line)
        {
            reader.read_instruction(instruction);
        }
    }
    found
}

/// Returns the instruction on a line of assembly, without its comment.
fn instruction_of_line(line: &str) -> Option<&str> {
    let text = line.strip_prefix('\t')?.split('#').next()?.trim_end();
    let is_one = text.starts_with(|c: char| c.is_ascii_alphabetic()) && !text.starts_with("nop");
    is_one.then_some(text)
}

#[derive(Default)]
struct RoutineReader {
    routine: Routine,
    /// Registers that hold the address of a function, with its name.
    addresses: BTreeMap<String, String>,
    /// Whether the code is a loop that allocates the stack page by page; its total is already counted.
    probing: bool,
}

impl RoutineReader {
    fn read_instruction(&mut self, instruction: &str) {
        self.routine.instructions += 1;
        let (name, operands) = instruction.split_once('\t').unwrap_or((instruction, ""));
        match name {
            "pushq" => self.routine.stack += 8,
            "subq" => self.record_stack_bytes(operands),
            "leaq" if operands.ends_with("(%rsp), %r11") && operands.starts_with('-') => {
                self.routine.stack += leading_integer(&operands[1..]);
                self.probing = true;
            }
            "jne" => self.probing = false,
            "movq" => self.record_address_copy(operands),
            "callq" | "jmp" | "jmpq" => self.record_call(operands),
            _ => {}
        }
        if let Some((function, register)) = operands.split_once("@GOTPCREL(%rip), ") {
            self.addresses.insert(register.to_string(), function.to_string());
        }
    }

    /// Records that an instruction copies the address of a function from one register to another.
    fn record_address_copy(&mut self, operands: &str) {
        if let Some((from, to)) = operands.split_once(", ")
            && let Some(function) = self.addresses.get(from)
        {
            self.addresses.insert(to.to_string(), function.clone());
        }
    }

    fn record_stack_bytes(&mut self, operands: &str) {
        if let Some(bytes) = operands.strip_suffix(", %rsp").and_then(|bytes| bytes.strip_prefix('$'))
            && !self.probing
        {
            self.routine.stack += leading_integer(bytes);
        }
    }

    fn record_call(&mut self, target: &str) {
        if let Some(address) = target.strip_prefix('*') {
            let direct = address.strip_suffix("@GOTPCREL(%rip)").map(str::to_string);
            match direct.or_else(|| self.addresses.get(address).cloned()) {
                Some(function) => self.routine.calls.insert(function),
                None => std::mem::replace(&mut self.routine.calls_by_address, true),
            };
        } else if !target.starts_with(".L") {
            let function = target.strip_suffix("@PLT").unwrap_or(target);
            self.routine.calls.insert(function.to_string());
        }
    }
}

fn leading_integer(text: &str) -> usize {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    text[..end].parse().unwrap_or(0)
}

/// Returns the name of a function in the source, without type arguments.
#[must_use]
pub fn name_in_source(symbol: &str) -> String {
    let full = format!("{:#}", demangle(symbol));
    let (mut name, mut depth) = (String::new(), 0);
    for (k, c) in full.char_indices() {
        match c {
            '<' => depth += 1,
            '>' => depth -= 1,
            _ if depth == 0 || k == 0 => name.push(c),
            _ => {}
        }
    }
    name.replace("::::", "::").trim_matches(':').to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\t.type\t_ZN4work5outer17h0123456789abcdefE,@function
_ZN4work5outer17h0123456789abcdefE:
\t.cfi_startproc
\tpushq\t%rbx
\t.cfi_def_cfa_offset 16
\tleaq\t-8192(%rsp), %r11
.LBB0_1:
\tsubq\t$4096, %rsp
\tmovq\t$0, (%rsp)
\tcmpq\t%r11, %rsp
\tjne\t.LBB0_1
\tsubq\t$24, %rsp
\tmovq\tmemcpy@GOTPCREL(%rip), %rbx
\tmovq\t%rbx, %r14
\tcallq\t*%r14
\tcallq\t*sin@GOTPCREL(%rip)
\tnopw\t(%rax)
\tjmp\t.LBB0_2
.LBB0_2:
\tjmp\t_ZN4work5inner17h0123456789abcdefE # TAILCALL
.Lfunc_end0:
\t.size\t_ZN4work5outer17h0123456789abcdefE, .Lfunc_end0-_ZN4work5outer17h0123456789abcdefE
\t.type\t_ZN4work5inner17h0123456789abcdefE,@function
_ZN4work5inner17h0123456789abcdefE:
\tcallq\t*16(%rax)
\tretq
.Lfunc_end1:
\t.size\t_ZN4work5inner17h0123456789abcdefE, .Lfunc_end1-_ZN4work5inner17h0123456789abcdefE
";

    #[test]
    fn calls_and_stack_frame_are_read_from_disassembly() {
        let found = parse_routines(TEXT);
        assert_eq!(found.len(), 2);
        let outer = &found["_ZN4work5outer17h0123456789abcdefE"];
        let calls: Vec<String> = outer.calls.iter().map(|call| name_in_source(call)).collect();
        assert_eq!(calls, ["work::inner", "memcpy", "sin"]);
        assert_eq!((outer.instructions, outer.stack, outer.calls_by_address), (13, 8 + 8192 + 24, false));
        let inner = &found["_ZN4work5inner17h0123456789abcdefE"];
        assert_eq!((inner.instructions, inner.stack, inner.calls_by_address), (2, 0, true));
        assert!(inner.calls.is_empty());
    }

    #[test]
    fn symbol_names_are_demangled_to_source_names() {
        let panic = "_ZN4core9panicking18panic_bounds_check17h0123456789abcdefE";
        assert_eq!(name_in_source(panic), "core::panicking::panic_bounds_check");
        let generic = "_ZN88_$LT$linkwork..arithmetic..Compiled$u20$as$u20$linkwork..lanes..registers..Registers$GT$6within17h5068f906a8b23952E";
        assert_eq!(name_in_source(generic), "within");
    }
}
