//! Map from nodes of a graph to numbers. The graph recycles the underlying tables, so that a map of few nodes
//! does not cost the allocation of a table for all nodes.

use super::Graph;
use super::node::Id;

/// Map from node indices to `u32`. Access takes the time of an array access. A new map allocates nothing if
/// the graph has an unused table.
pub struct Memo<'g> {
    graph: &'g Graph,
    /// Table with one entry per node: its number plus one, or zero if the node has none. The table may be
    /// shorter than the graph.
    table: Vec<u32>,
    /// Indices of the nodes to which numbers are assigned.
    written: Vec<Id>,
}

impl<'g> Memo<'g> {
    /// Creates an empty map for the nodes of a graph.
    pub fn new(graph: &'g Graph) -> Memo<'g> {
        Memo { graph, table: graph.take_memo_table(), written: Vec::new() }
    }

    /// Returns the number assigned to a node; `None` if none is assigned.
    pub fn get(&self, id: Id) -> Option<u32> {
        match self.table.get(id as usize) {
            None | Some(0) => None,
            Some(number) => Some(number - 1),
        }
    }

    /// Assigns a number less than `u32::MAX` to a node of the graph.
    pub fn assign_number(&mut self, id: Id, number: u32) {
        let place = id as usize;
        if place >= self.table.len() {
            self.table.resize(self.graph.len().max(place + 1), 0);
        }
        self.table[place] = number.saturating_add(1);
        self.written.push(id);
    }
}

impl Drop for Memo<'_> {
    fn drop(&mut self) {
        for id in &self.written {
            self.table[*id as usize] = 0;
        }
        self.graph.recycle_memo_table(std::mem::take(&mut self.table));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn memo_tables_are_recycled_empty() {
        let g = Graph::new();
        let x = g.symbol(Symbol(0));
        let mut first = Memo::new(&g);
        first.assign_number(x.id(), 7);
        first.assign_number(0, 0);
        let mut second = Memo::new(&g);
        assert_eq!((first.get(x.id()), first.get(0), second.get(x.id())), (Some(7), Some(0), None));
        second.assign_number(x.sin().id(), 1);
        drop((first, second));
        let (third, fourth) = (Memo::new(&g), Memo::new(&g));
        assert!(!third.table.is_empty() && !fourth.table.is_empty());
        for id in 0..g.len() as Id {
            assert_eq!((third.get(id), fourth.get(id)), (None, None));
        }
    }
}
