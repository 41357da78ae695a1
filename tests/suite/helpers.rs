//! Helpers: any number of them, at any speed, that come and go, change no bit of a list or an alignment.

use core::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use sim3align::align::helper::Helper;
use sim3align::align::search::Request;
use sim3align::align::{align, align_task};
use sim3align::helpers::{Helpers, Link, Part, READY, Tasks};
use sim3align::pauses::{Pauses, finished};
use sim3align::precise::searched::ranking::Found;
use sim3align::precise::searched::recipe::Task;
use sim3align::precise::searched::tasks::{Outcome, RoundTasks, Run};

use crate::prelude::*;
use crate::shapes::{body, observe};

/// A helper: reads a message, if there is one, or runs some tasks and returns the message about them.
type Work = Box<dyn FnMut(Option<Vec<f64>>) -> Option<Vec<f64>>>;

/// A helper in the same thread, and the messages that are on their way to it.
struct Member {
    work: Work,
    inbox: VecDeque<Vec<f64>>,
    is_here: bool,
}

/// Helpers that work, come and go at random moments; at most one message arrives at a time.
struct Crew {
    members: Vec<Member>,
    arrived: VecDeque<Vec<f64>>,
    random: Random,
    /// One moment in so many, a helper leaves.
    one_leaves_in: usize,
    /// Number of tasks' messages that have arrived.
    answers: usize,
}

#[derive(Clone)]
struct Crowd(Rc<RefCell<Crew>>);

impl Crowd {
    fn new(seed: u64, one_leaves_in: usize, works: Vec<Work>) -> Self {
        let members = works.into_iter().map(|work| Member { work, inbox: VecDeque::new(), is_here: false }).collect();
        let random = Random::new(seed, 33);
        Self(Rc::new(RefCell::new(Crew { members, arrived: VecDeque::new(), random, one_leaves_in, answers: 0 })))
    }
}

impl Crew {
    /// One moment of one helper.
    fn moment(&mut self) {
        if self.members.is_empty() {
            return;
        }
        let k = self.random.below(self.members.len());
        let leaves = self.one_leaves_in > 0 && self.random.below(self.one_leaves_in) == 0;
        let member = &mut self.members[k];
        if !member.is_here {
            // It comes, if it has not left for good.
            if member.inbox.is_empty() {
                member.is_here = true;
                self.arrived.push_back([&[k as f64], &READY[1..]].concat());
            }
        } else if leaves {
            member.is_here = false;
            // It never comes back.
            member.inbox.push_back(Vec::new());
            self.arrived.push_back(vec![k as f64]);
        } else {
            let message = member.inbox.pop_front();
            if let Some(mut answer) = (member.work)(message) {
                self.answers += 1;
                answer[0] = k as f64;
                self.arrived.push_back(answer);
            }
        }
    }
}

impl Link for Crowd {
    fn ask(&self) {}

    fn send(&self, helper: usize, message: &[f64]) {
        let member = &mut self.0.borrow_mut().members[helper];
        if member.is_here {
            member.inbox.push_back(message.to_vec());
        }
    }

    fn receive(&self) -> Option<Vec<f64>> {
        let mut crew = self.0.borrow_mut();
        for _ in 0..crew.random.below(4) {
            crew.moment();
        }
        crew.arrived.pop_front()
    }

    fn wait(&self) {
        let mut crew = self.0.borrow_mut();
        for _ in 0..10_000 {
            if !crew.arrived.is_empty() {
                return;
            }
            crew.moment();
        }
        panic!("nobody works, and the list waits");
    }
}

/// Tasks whose results are their squares.
#[derive(Clone, Copy)]
struct Squares {
    count: usize,
    offset: u64,
}

impl Tasks for Squares {
    type Result = u64;

    fn count(&self) -> usize {
        self.count
    }

    fn run(&mut self, task: usize) -> u64 {
        (task as u64 + self.offset).pow(2)
    }

    fn write(&self, message: &mut Vec<f64>) {
        message.extend([self.count as f64, self.offset as f64]);
    }

    fn write_result(result: &u64, message: &mut Vec<f64>) {
        message.push(*result as f64);
    }

    fn read_result(message: &mut &[f64]) -> Option<u64> {
        let (result, rest) = message.split_first()?;
        *message = rest;
        Some(*result as u64)
    }
}

/// A helper that runs up to `most` tasks at a time.
fn squaring(most: usize) -> Work {
    let (mut part, mut tasks): (Option<Part>, Option<Squares>) = (None, None);
    Box::new(move |message| match message {
        Some(message) => {
            let (next, read) = Part::read(&message, part.as_ref()).unwrap();
            part = Some(next);
            if let &[count, offset] = read {
                tasks = Some(Squares { count: count as usize, offset: offset as u64 });
            }
            None
        }
        None => {
            let mut left = most;
            let is_time = || {
                left -= 1;
                left == 0
            };
            part.as_mut()?.run(&mut tasks?, is_time)
        }
    })
}

#[wasm_bindgen_test(unsupported = test)]
fn the_results_of_a_list_are_those_without_helpers() {
    for seed in 0..300 {
        let mut random = Random::new(seed, 34);
        let works = (0..random.below(5)).map(|_| squaring(1 + random.below(7))).collect();
        let helpers = Helpers::new(Crowd::new(seed, [0, 4, 40][random.below(3)], works));
        let pauses = Pauses::none().with_helpers(helpers);
        for list in 0..4 {
            let mut squares = Squares { count: random.below(60), offset: random.below(1000) as u64 };
            let last = random.below(80);
            let run = |pauses: &Pauses| {
                let mut seen = Vec::new();
                let ends = |result: &u64| {
                    seen.push(*result);
                    seen.len() > last
                };
                let found = finished(pauses.list(&mut squares, ends));
                assert_eq!(found, seen, "seed {seed}, list {list}: in order, each once");
                found
            };
            let [with, without] = [&pauses, &Pauses::none()].map(run);
            assert_eq!(with, without, "seed {seed}, list {list}");
        }
    }
}

#[wasm_bindgen_test(unsupported = test)]
fn tasks_and_results_arrive_as_they_were_sent() {
    for seed in 0..50 {
        let mut random = Random::new(seed, 35);
        let mut number = || random.uniform() - 0.5;
        let mut pose = || CropPose {
            rotation: DQuat::from_xyzw(number(), number(), number(), number()).normalize(),
            size: number(),
            place: DVec2::new(number(), 1e-300 * number()),
            distance: 1e300 * number(),
        };
        let poses: Vec<CropPose> = (0..seed % 4).map(|_| pose()).collect();
        let rotations: Vec<DQuat> = (0..seed % 3).map(|_| pose().rotation).collect();
        let sent = RoundTasks {
            view: seed as usize,
            effort: [Effort::Fast, Effort::Balanced, Effort::Best][seed as usize % 3],
            is_surrounded: seed % 2 == 0,
            task: [Task::Rotate, Task::Place, Task::Refine, Task::Turn, Task::Fit][seed as usize % 5],
            grid: seed as usize % 5,
            work: 4000,
            best: (seed % 7 > 0).then(|| number() as f32),
            rotations: rotations.into(),
            poses: poses.clone().into(),
        };
        let mut message = Vec::new();
        sent.write(&mut message);
        assert_eq!(RoundTasks::read(&message).as_ref(), Some(&sent), "seed {seed}");
        for cut in 0..message.len() {
            assert_eq!(RoundTasks::read(&message[..cut]), None, "seed {seed}, {cut} numbers");
        }
        let mut score = || number() as f32;
        let score = Score {
            total: score(),
            hidden: score(),
            counts: [score(), f32::MAX, f32::MIN_POSITIVE],
            ..Score::default()
        };
        let found = |pose| Found { pose, score, renders: seed as usize, converged: seed % 2 == 0 };
        let results: Vec<Outcome> =
            poses.iter().map(|pose| Outcome { found: vec![found(*pose); 2], work: 1 << 40 }).collect();
        let mut message = Vec::new();
        results.iter().for_each(|result| Run::write_result(result, &mut message));
        let mut rest = message.as_slice();
        for sent in &results {
            let read = Run::read_result(&mut rest).unwrap();
            let numbers = |outcome: &Outcome| {
                let numbers = |f: &Found| (f.pose, f.score, f.renders, f.converged);
                (outcome.work, outcome.found.iter().map(numbers).collect::<Vec<_>>())
            };
            assert_eq!(numbers(&read), numbers(sent), "seed {seed}");
        }
        assert!(Run::read_result(&mut rest).is_none(), "nothing is left");
    }
}

/// Helpers of an alignment that run one task at a time.
fn aligning(mesh: &Mesh, options: &AlignOptions) -> Work {
    let request = Request::new(options.clone()).unwrap();
    let prepared = Rc::new(PreparedMesh::new(mesh.clone()));
    let mut helper = Helper::new(vec![Some(observe(mesh, 1.0))], prepared, request, |_| ());
    Box::new(move |message| match message {
        Some(message) => {
            helper.receive(&message);
            None
        }
        None => helper.step(|| true),
    })
}

#[wasm_bindgen_test(unsupported = test)]
fn an_alignment_with_helpers_has_the_same_bits() {
    let mesh = body();
    let options = AlignOptions { work_budget: Some(30.0), ..AlignOptions::default() };
    let alone = align(&observe(&mesh, 1.0), &mesh, &options, &mut Silent).unwrap();
    for (seed, (count, one_leaves_in)) in (0..).zip([(1, 0), (3, 0), (2, 200)]) {
        let crowd = Crowd::new(seed, one_leaves_in, (0..count).map(|_| aligning(&mesh, &options)).collect());
        let pauses = Pauses::none().with_helpers(Helpers::new(crowd.clone()));
        let mut task =
            align_task(observe(&mesh, 1.0), PreparedMesh::borrowed(&mesh), options.clone(), Silent, pauses).unwrap();
        let found = loop {
            if let Some(found) = task.step(f64::INFINITY).unwrap() {
                break found;
            }
        };
        assert_eq!(found, alone, "{count} helpers");
        assert!(crowd.0.borrow().answers > 20, "they helped: {}", crowd.0.borrow().answers);
    }
}
