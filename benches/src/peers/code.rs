//! Sizes of generated functions in machine code, from the symbols of this program.

use object::{Object, ObjectKind, ObjectSymbol};
use std::any::type_name;
use std::collections::HashMap;
use std::sync::OnceLock;

/// Smallest size of machine code in bytes that is reported; a smaller function only calls others.
const SMALLEST: u64 = 500;

/// Returns the bytes of machine code of the function `name` of the mechanism `M`, plus those of its caller at
/// an address, into which it may have been inlined. Returns `None` if it only calls other functions, or if
/// the system does not report the sizes.
pub fn machine_code_size<M>(caller: *const (), name: &str) -> Option<u64> {
    static SIZES: OnceLock<Option<SymbolCodeSizes>> = OnceLock::new();
    let sizes = SIZES.get_or_init(SymbolCodeSizes::read_symbol_sizes).as_ref()?;
    let mechanism = type_name::<M>().rsplit("::").next()?;
    // Mangled names contain each identifier after its length.
    let end = format!("{}{mechanism}{}{name}", mechanism.len(), name.len());
    let own = sizes.names.iter().filter(|(symbol, _)| symbol.contains(&end)).map(|(_, size)| size).max();
    let all = sizes.addresses.get(&(caller as u64))? + own.unwrap_or(&0);
    (all >= SMALLEST).then_some(all)
}

struct SymbolCodeSizes {
    addresses: HashMap<u64, u64>,
    names: Vec<(String, u64)>,
}

impl SymbolCodeSizes {
    fn read_symbol_sizes() -> Option<SymbolCodeSizes> {
        let path = std::env::current_exe().ok()?;
        // The first line of the map is the start address of this program in memory.
        let maps = std::fs::read_to_string("/proc/self/maps").ok()?;
        let line = maps.lines().find(|line| line.ends_with(&*path.to_string_lossy()))?;
        let start = u64::from_str_radix(line.split('-').next()?, 16).ok()?;
        let file = std::fs::read(&path).ok()?;
        let file = object::File::parse(&*file).ok()?;
        let offset = if file.kind() == ObjectKind::Dynamic { start } else { 0 };
        let symbol_name = |symbol: &object::Symbol<'_, '_>| symbol.name().unwrap_or_default().to_string();
        Some(SymbolCodeSizes {
            addresses: file.symbols().map(|symbol| (symbol.address() + offset, symbol.size())).collect(),
            names: file.symbols().map(|symbol| (symbol_name(&symbol), symbol.size())).collect(),
        })
    }
}
