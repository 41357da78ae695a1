//! The work of a call, counted with the feature `counts`: in the lab, never in a module.

/// Counts of work.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "counts", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "counts", serde(default))]
pub struct Counts {
    /// Images that the search drew: one per pose.
    pub renders: u64,
    /// Vertices that were projected, by either rasteriser.
    pub vertices: u64,
    /// Triangles whose corners were gathered, by either rasteriser.
    pub triangles: u64,
    /// Triangles of the search that were filled: not those whose box has no centre of a cell.
    pub filled: u64,
    /// Cells that were compared with a triangle, about, by either rasteriser.
    pub visited: u64,
    /// Cells of the search's grids.
    pub cells: u64,
    /// Queries of the nearest points and triangles.
    pub queries: u64,
    /// Points and triangles of which trees were built.
    pub sorted: u64,
}

#[cfg(feature = "counts")]
mod counted {
    use core::cell::Cell;

    use super::Counts;

    thread_local! {
        static ALL: Cell<Counts> = Cell::default();
    }

    impl Counts {
        /// These and those.
        #[must_use]
        pub fn and(&self, other: &Self) -> Self {
            self.with(other, u64::wrapping_add)
        }

        /// These without those before them.
        #[must_use]
        pub fn since(&self, before: &Self) -> Self {
            self.with(before, u64::wrapping_sub)
        }

        fn with(&self, other: &Self, of: fn(u64, u64) -> u64) -> Self {
            Self {
                renders: of(self.renders, other.renders),
                vertices: of(self.vertices, other.vertices),
                triangles: of(self.triangles, other.triangles),
                filled: of(self.filled, other.filled),
                visited: of(self.visited, other.visited),
                cells: of(self.cells, other.cells),
                queries: of(self.queries, other.queries),
                sorted: of(self.sorted, other.sorted),
            }
        }
    }

    /// The counts of this thread so far.
    pub fn so_far() -> Counts {
        ALL.get()
    }

    /// Adds to the counts of this thread.
    pub fn add(of: impl FnOnce() -> Counts) {
        ALL.set(ALL.get().and(&of()));
    }
}

#[cfg(feature = "counts")]
pub use counted::{add, so_far};

/// Counts nothing.
#[cfg(not(feature = "counts"))]
#[inline(always)]
pub fn add(_: impl FnOnce() -> Counts) {}
