//! Pauses and bounds of calls that are written as they run: straight-line code that awaits a pause point.
//!
//! A call never waits for anything but its caller, so that no executor is needed: a step polls it until its next pause.

use core::cell::Cell;
use core::future::Future;
use core::pin::{Pin, pin};
use core::task::{Context, Poll, Waker};
use std::rc::Rc;

use crate::error::{Error, ErrorCode, Result};
use crate::helpers::{Helpers, Tasks};

/// The pause points of a call, and the work that it has left. Results depend on the work, never on the pauses.
pub struct Pauses {
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

impl Pauses {
    /// Pauses by a clock, and a bound on the work, if there is one.
    pub fn new(clock: fn() -> f64, work_budget: Option<f64>) -> Self {
        let [until, left] = [f64::INFINITY, work_budget.unwrap_or(f64::INFINITY)].map(Cell::new);
        Self { clock, until, left, since: Cell::new(0.0), most: Cell::new(0.0), helpers: Helpers::default() }
    }

    /// With other threads that may help.
    pub fn with_helpers(self, helpers: Helpers) -> Self {
        Self { helpers, ..self }
    }

    /// No pause, and no bound.
    pub fn none() -> Self {
        Self::new(|| 0.0, None)
    }

    /// Counts work of so many units.
    pub fn spend(&self, work: f64) {
        self.left.set(self.left.get() - work);
        self.since.set(self.since.get() + work);
    }

    /// Pauses if it is time, after work of so many units: about milliseconds on a laptop.
    pub fn point(&self, work: f64) -> Point {
        self.spend(work);
        Point { is_due: self.since.get() >= GRAIN && self.is_time() }
    }

    /// Pauses if it is time, whatever the work was: for calls that have another bound.
    pub fn here(&self) -> Point {
        Point { is_due: self.is_time() }
    }

    /// Asks for helpers, where there may be some, and pauses: long lists of tasks are to come.
    pub fn ask_for_help(&self) -> Point {
        Point { is_due: self.helpers.ask() }
    }

    /// The results of independent tasks in their order, with a pause point after each task. `ends` sees them in this order,
    /// and is true of the last one that is needed.
    pub async fn list<T: Tasks>(&self, tasks: &mut T, ends: impl FnMut(&T::Result) -> bool) -> Vec<T::Result> {
        self.helpers.run(tasks, ends, |always| Point { is_due: always || self.is_time() }).await
    }

    #[inline(never)]
    fn is_time(&self) -> bool {
        let since = self.since.replace(0.0);
        self.most.set(self.most.get().max(since));
        (self.clock)() >= self.until.get()
    }

    /// Whether the call goes on: there is work left, or it has no result yet.
    pub fn goes_on(&self, has_result: bool) -> bool {
        !has_result || self.left.get() > 0.0
    }
}

/// A pause point, to be awaited.
pub struct Point {
    is_due: bool,
}

impl Future for Point {
    type Output = ();

    fn poll(mut self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<()> {
        if core::mem::take(&mut self.is_due) { Poll::Pending } else { Poll::Ready(()) }
    }
}

/// A call in steps.
pub struct Task<'a, T> {
    pauses: Rc<Pauses>,
    call: Option<Boxed<'a, Result<T>>>,
}

impl<'a, T: 'a> Task<'a, T> {
    /// A call that has not begun.
    pub fn new<F: Future<Output = Result<T>> + 'a>(pauses: Pauses, call: impl FnOnce(Rc<Pauses>) -> F) -> Self {
        let pauses = Rc::new(pauses);
        Self { call: Some(boxed(call(pauses.clone()))), pauses }
    }

    /// The most work that was done so far without a pause point.
    pub fn longest_block(&self) -> f64 {
        self.pauses.most.get()
    }

    /// Continues until the call is finished, and returns its result, or until its first pause point after a time of its
    /// clock.
    ///
    /// # Errors
    /// Those of the call, which then ends.
    pub fn step(&mut self, until: f64) -> Result<Option<T>> {
        self.pauses.until.set(until);
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

/// Runs a call to its end, without a pause.
pub fn finished<T>(call: impl Future<Output = T>) -> T {
    let mut call = pin!(call);
    loop {
        if let Poll::Ready(result) = call.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            return result;
        }
    }
}
