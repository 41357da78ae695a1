//! Helpers: other threads that take parts of a call's lists of independent tasks.
//!
//! The call and its helpers each have a share of the tasks of a list and go through it forwards. One that has finished takes
//! the back part of the largest share. The results of a list are used in the order of its tasks: neither the number of
//! helpers nor their speed changes a bit. What travels are numbers, without loss: with a serialiser (`postcard`), the core module is
//! 2.5 kB larger, gzipped, for 49 lines less.

use core::cell::{Cell, RefCell};
use core::ops::Range;

/// Carries messages between a call and its helpers.
pub trait Link {
    /// Asks for helpers. They may join at any time, or never.
    fn ask(&self);

    /// Sends a message to a helper.
    fn send(&self, helper: usize, message: &[f64]);

    /// The next message that has arrived: the helper that sent it, and [`READY`] or what [`Part::run`] has made. Nothing but
    /// the helper reports that it has left.
    fn receive(&self) -> Option<Vec<f64>>;

    /// Lets the next pause last until a message arrives.
    fn wait(&self);
}

/// Independent tasks.
pub trait Tasks {
    /// The result of a task.
    type Result;

    /// Number of tasks.
    fn count(&self) -> usize;

    /// Runs a task. Its result depends on nothing that has run before.
    fn run(&mut self, task: usize) -> Self::Result;

    /// Writes what a helper needs to run them.
    fn write(&self, message: &mut Vec<f64>);

    /// Writes a result.
    fn write_result(result: &Self::Result, message: &mut Vec<f64>);

    /// Reads a result, and takes it off the message.
    fn read_result(message: &mut &[f64]) -> Option<Self::Result>;
}

/// Writes numbers.
#[inline(never)]
pub fn put(message: &mut Vec<f64>, numbers: &[f64]) {
    message.extend_from_slice(numbers);
}

/// The first message of a helper, whose first number is for the helper.
pub const READY: [f64; 3] = [0.0; 3];

/// The helpers of a call; none by default.
#[derive(Default)]
pub struct Helpers {
    link: Option<Box<dyn Link>>,
    /// Those that are ready.
    present: RefCell<Vec<usize>>,
    /// Number of lists so far.
    lists: Cell<usize>,
}

/// A part of a list, as a helper has it.
pub struct Part {
    /// The number of the list.
    list: usize,
    /// The first task.
    first: usize,
    /// The tasks that are left.
    left: Range<usize>,
}

/// Numbers before the tasks in a message to a helper: the list, and the range of its part.
const HEADER: usize = 3;

/// The share of one participant.
struct Share {
    /// The helper; `None` for the call itself.
    helper: Option<usize>,
    left: Range<usize>,
    /// Whether the helper has the list.
    has_list: bool,
    /// Whether the helper has this share.
    has_share: bool,
    /// Whether the helper has left.
    is_orphaned: bool,
}

impl Helpers {
    /// Helpers that this link brings.
    pub fn new(link: impl Link + 'static) -> Self {
        Self { link: Some(Box::new(link)), ..Self::default() }
    }

    /// Asks for helpers. Returns whether there may be some.
    pub fn ask(&self) -> bool {
        self.link.iter().for_each(|link| link.ask());
        self.link.is_some()
    }

    /// Runs tasks, with a yield point after each, until `ends` is true of a result: it gets them in order. `pause(true)` pauses in
    /// any case, `pause(false)` if it is time.
    pub async fn run<T: Tasks, P: Future<Output = ()>>(
        &self,
        tasks: &mut T,
        mut ends: impl FnMut(&T::Result) -> bool,
        pause: impl Fn(bool) -> P,
    ) -> Vec<T::Result> {
        let list = self.lists.get() + 1;
        self.lists.set(list);
        let mut shares = vec![Share::of(None, 0..tasks.count())];
        shares.extend(self.present.borrow_mut().drain(..).map(|helper| Share::of(Some(helper), 0..0)));
        let mut results: Vec<Option<T::Result>> = Vec::new();
        results.resize_with(tasks.count(), || None);
        let mut seen = 0;
        loop {
            for message in self.link.iter().flat_map(|link| core::iter::from_fn(|| link.receive())) {
                let Some((&helper, message)) = message.split_first() else { continue };
                share_of(&mut shares, helper as usize).is_orphaned = message.is_empty();
                let Some((&[of_list, first], mut message)) = message.split_first_chunk() else { continue };
                if of_list as usize == list {
                    for result in results.iter_mut().skip(first as usize) {
                        let Some(found) = T::read_result(&mut message) else { break };
                        *result = Some(found);
                    }
                }
            }
            let mut has_ended = results.is_empty();
            while !has_ended && let Some(Some(result)) = results.get(seen) {
                seen += 1;
                has_ended = ends(result) || seen == results.len();
            }
            if has_ended {
                break;
            }
            for Share { left, .. } in &mut shares {
                left.start += results[left.clone()].iter().take_while(|result| result.is_some()).count();
            }
            balance(&mut shares);
            for share in &mut shares {
                let (Some(helper), Some(link), false) = (share.helper, &self.link, share.has_share) else { continue };
                let mut message = Vec::new();
                put(&mut message, &[list, share.left.start, share.left.end].map(|x| x as f64));
                if !share.has_list {
                    tasks.write(&mut message);
                }
                link.send(helper, &message);
                (share.has_list, share.has_share) = (true, true);
            }
            if let Some(task) = shares[0].left.next() {
                results[task] = Some(tasks.run(task));
                pause(false).await;
            } else {
                // Helpers have begun what is left.
                self.link.iter().for_each(|link| link.wait());
                pause(true).await;
            }
        }
        let present = shares.iter().filter(|share| !share.is_orphaned).filter_map(|share| share.helper);
        self.present.borrow_mut().extend(present);
        results.into_iter().take(seen).flatten().collect()
    }
}

/// The share of a helper, which is a new one if it has none.
fn share_of(shares: &mut Vec<Share>, helper: usize) -> &mut Share {
    let known = shares.iter().position(|share| share.helper == Some(helper));
    let place = known.unwrap_or(shares.len());
    if known.is_none() {
        shares.push(Share::of(Some(helper), 0..0));
    }
    &mut shares[place]
}

/// Gives those that have finished a part of the largest share.
fn balance(shares: &mut [Share]) {
    let mut idle = shares.iter().filter(|share| share.is_idle()).count();
    for taker in 0..shares.len() {
        if !shares[taker].is_idle() {
            continue;
        }
        let Some(giver) = (0..shares.len()).max_by_key(|&k| shares[k].free()) else { return };
        let free = shares[giver].free();
        // Those that follow take as much, and the giver keeps as much.
        let taken = if shares[giver].is_orphaned { free } else { free.div_ceil(idle + 1) };
        if taken == 0 {
            return;
        }
        idle -= 1;
        let Range { start, end } = shares[giver].left;
        shares[giver].change(start..end - taken);
        shares[taker].change(end - taken..end);
    }
}

impl Share {
    fn of(helper: Option<usize>, left: Range<usize>) -> Self {
        Self { helper, left, has_list: false, has_share: true, is_orphaned: false }
    }

    fn is_idle(&self) -> bool {
        self.left.is_empty() && !self.is_orphaned
    }

    /// Number of tasks that another participant can take: a helper has begun the first one.
    fn free(&self) -> usize {
        self.left.len().saturating_sub(usize::from(!self.is_orphaned))
    }

    fn change(&mut self, left: Range<usize>) {
        self.left = left;
        self.has_share = self.is_orphaned;
    }
}

impl Part {
    /// Reads a message of a call to a helper that has had a part `before`; and the tasks of the list, which are empty if the
    /// helper knows them.
    pub fn read<'a>(message: &'a [f64], before: Option<&Self>) -> Option<(Self, &'a [f64])> {
        let (header, tasks) = message.split_first_chunk::<HEADER>()?;
        let [list, first, end] = header.map(|x| x as usize);
        // Where it is a shorter share, the helper has gone on since.
        let is_shorter = |before: &&Self| before.list == list && (before.first..=before.left.start).contains(&first);
        let next = before.filter(is_shorter).map_or(first, |before| before.left.start);
        Some((Self { list, first, left: next.min(end)..end }, tasks))
    }

    /// Runs tasks of the part until it is time; the message about them, or `None` if no task is left.
    pub fn run<T: Tasks>(&mut self, tasks: &mut T, mut is_time: impl FnMut() -> bool) -> Option<Vec<f64>> {
        let mut message = Vec::new();
        put(&mut message, &[0, self.list, self.left.start].map(|x| x as f64));
        self.left.end = self.left.end.min(tasks.count());
        for task in self.left.by_ref() {
            T::write_result(&tasks.run(task), &mut message);
            if is_time() {
                break;
            }
        }
        (message.len() > READY.len()).then_some(message)
    }
}
