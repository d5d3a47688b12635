//! A number for some nodes of a graph, in a table that the graph keeps for the next one: what concerns few nodes does not
//! cost a table for all of them.

use super::Graph;
use super::node::Id;

/// Numbers of nodes. Reading and writing one takes the time of an index; a new table costs nothing, once the graph has one
/// that is not in use.
pub struct Memo<'g> {
    graph: &'g Graph,
    /// By node: the number plus one; zero, or nothing, where there is none.
    table: Vec<u32>,
    /// The nodes that have numbers.
    written: Vec<Id>,
}

impl<'g> Memo<'g> {
    /// No numbers yet.
    pub fn new(graph: &'g Graph) -> Memo<'g> {
        Memo { graph, table: graph.take_table(), written: Vec::new() }
    }

    /// The number of a node.
    pub fn get(&self, id: Id) -> Option<u32> {
        match self.table.get(id as usize) {
            None | Some(0) => None,
            Some(number) => Some(number - 1),
        }
    }

    /// Gives a node a number, which is not the largest there is.
    pub fn set(&mut self, id: Id, number: u32) {
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
        self.graph.keep_table(std::mem::take(&mut self.table));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn tables_are_used_again_and_empty() {
        let g = Graph::new();
        let x = g.symbol(Symbol(0));
        let mut first = Memo::new(&g);
        first.set(x.id(), 7);
        first.set(0, 0);
        let mut second = Memo::new(&g);
        assert_eq!((first.get(x.id()), first.get(0), second.get(x.id())), (Some(7), Some(0), None));
        second.set(x.sin().id(), 1);
        drop((first, second));
        let (third, fourth) = (Memo::new(&g), Memo::new(&g));
        assert!(!third.table.is_empty() && !fourth.table.is_empty());
        for id in 0..g.len() as Id {
            assert_eq!((third.get(id), fourth.get(id)), (None, None));
        }
    }
}
