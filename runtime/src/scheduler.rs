//! Cooperative scheduling of long calls, which are straight-line code that awaits a yield point here and there, and the
//! bound on their work.
//!
//! A call never waits for anything but its caller, so that no executor is needed: a step polls it until it next yields.

use core::cell::Cell;
use core::future::Future;
use core::pin::{Pin, pin};
use core::task::{Context, Poll, Waker};
use std::rc::Rc;

use crate::error::{Error, ErrorCode, Result};
use crate::helpers::{Helpers, Tasks};

/// The yield points of a call, and the work that it has left. Results depend on the work, never on the yields.
pub struct Scheduler {
    clock: fn() -> f64,
    until: Cell<f64>,
    left: Cell<f64>,
    /// Work since the clock was asked, and the most that ever was.
    since: Cell<f64>,
    most: Cell<f64>,
    helpers: Helpers,
}

/// Work after which the clock is asked: it is a function of JavaScript, which takes as long as several distances.
const GRAIN: f64 = 1.0;

impl Scheduler {
    /// Yields by a clock, with a bound on the work, if there is one.
    pub fn new(clock: fn() -> f64, work_budget: Option<f64>) -> Self {
        let [until, left] = [f64::INFINITY, work_budget.unwrap_or(f64::INFINITY)].map(Cell::new);
        Self { clock, until, left, since: Cell::new(0.0), most: Cell::new(0.0), helpers: Helpers::default() }
    }

    /// With other threads that may help.
    pub fn with_helpers(self, helpers: Helpers) -> Self {
        Self { helpers, ..self }
    }

    /// Never yields, and has no bound.
    pub fn unbounded() -> Self {
        Self::new(|| 0.0, None)
    }

    /// Counts work of so many units.
    pub fn spend(&self, work: f64) {
        self.left.set(self.left.get() - work);
        self.since.set(self.since.get() + work);
    }

    /// Yields if it is time, after work of so many units: about milliseconds on a laptop.
    pub fn yield_after(&self, work: f64) -> YieldPoint {
        self.spend(work);
        YieldPoint { is_due: self.since.get() >= GRAIN && self.is_time() }
    }

    /// Yields if it is time, whatever the work was: for calls that have another bound.
    pub fn yield_point(&self) -> YieldPoint {
        YieldPoint { is_due: self.is_time() }
    }

    /// Asks for helpers, where there may be some, and yields: long lists of tasks are to come.
    pub fn ask_for_help(&self) -> YieldPoint {
        YieldPoint { is_due: self.helpers.ask() }
    }

    /// The results of independent tasks in their order, with a yield point after each task. `ends` sees them in this order,
    /// and is true of the last one that is needed.
    pub async fn run_tasks<T: Tasks>(&self, tasks: &mut T, ends: impl FnMut(&T::Result) -> bool) -> Vec<T::Result> {
        self.helpers.run(tasks, ends, |always| YieldPoint { is_due: always || self.is_time() }).await
    }

    #[inline(never)]
    fn is_time(&self) -> bool {
        let since = self.since.replace(0.0);
        self.most.set(self.most.get().max(since));
        (self.clock)() >= self.until.get()
    }

    /// Whether the call continues: there is work left, or it has no result yet.
    pub fn may_continue(&self, has_result: bool) -> bool {
        !has_result || self.left.get() > 0.0
    }
}

/// A yield point, to be awaited.
pub struct YieldPoint {
    is_due: bool,
}

impl Future for YieldPoint {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<()> {
        if core::mem::take(&mut self.is_due) { Poll::Pending } else { Poll::Ready(()) }
    }
}

/// A call in steps.
pub struct Task<'a, T> {
    scheduler: Rc<Scheduler>,
    call: Option<Boxed<'a, Result<T>>>,
}

impl<'a, T: 'a> Task<'a, T> {
    /// A call that has not begun.
    pub fn new<F: Future<Output = Result<T>> + 'a>(
        scheduler: Scheduler,
        call: impl FnOnce(Rc<Scheduler>) -> F,
    ) -> Self {
        let scheduler = Rc::new(scheduler);
        Self { call: Some(boxed(call(scheduler.clone()))), scheduler }
    }

    /// The most work that was done so far without a yield point.
    pub fn longest_block(&self) -> f64 {
        self.scheduler.most.get()
    }

    /// Continues until the call is finished, and returns its result, or until its first yield point after a time of its
    /// clock.
    ///
    /// # Errors
    /// Those of the call, which then ends.
    pub fn step(&mut self, until: f64) -> Result<Option<T>> {
        self.scheduler.until.set(until);
        let Some(call) = &mut self.call else {
            return Err(Error::new(
                ErrorCode::Internal,
                "task",
                "a finished task",
                "a running task",
                "Create another task.",
            ));
        };
        match call.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            Poll::Pending => Ok(None),
            Poll::Ready(result) => {
                self.call = None;
                result.map(Some)
            }
        }
    }
}

/// A call on the heap. A function that returns one is compiled in its own crate, while every crate that calls an `async fn`
/// has a copy of its code.
pub type Boxed<'a, T> = Pin<Box<dyn Future<Output = T> + 'a>>;

/// Puts a call on the heap.
pub fn boxed<'a, F: Future + 'a>(call: F) -> Boxed<'a, F::Output> {
    Box::pin(call)
}

/// Runs a call to its end, without yielding.
pub fn finished<T>(call: impl Future<Output = T>) -> T {
    let mut call = pin!(call);
    loop {
        if let Poll::Ready(result) = call.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return result;
        }
    }
}
