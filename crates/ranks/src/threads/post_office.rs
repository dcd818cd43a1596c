//! Messages between threads, and an end for all when one of them fails.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// What one rank sends to another one.
pub enum Message {
    /// Numbers of `exchange`.
    Exchange(Vec<f64>),
    /// A part of `all_gather`.
    Gather(Vec<f64>),
    /// The bytes of `broadcast`.
    Broadcast(Vec<u8>),
}

impl Message {
    /// The call that sends it.
    pub fn call(&self) -> &'static str {
        match self {
            Message::Exchange(_) => "exchange",
            Message::Gather(_) => "all_gather",
            Message::Broadcast(_) => "broadcast",
        }
    }
}

/// What a rank does.
#[derive(Clone, Copy, PartialEq)]
enum Activity {
    Works,
    WaitsFor(usize),
    HasLeft,
}

/// Keeps messages until they are fetched.
pub struct PostOffice {
    desk: Mutex<Desk>,
    news: Condvar,
}

struct Desk {
    /// Messages, first in, first out, at place [to][from].
    boxes: Vec<Vec<VecDeque<Message>>>,
    activities: Vec<Activity>,
    first_failure: Option<usize>,
}

impl PostOffice {
    /// For `size` ranks.
    pub fn new(size: usize) -> Self {
        let row = || (0..size).map(|_| VecDeque::new()).collect();
        let boxes = (0..size).map(|_| row()).collect();
        let desk = Desk { boxes, activities: vec![Activity::Works; size], first_failure: None };
        Self { desk: Mutex::new(desk), news: Condvar::new() }
    }

    /// How many ranks there are.
    pub fn size(&self) -> usize {
        self.desk().activities.len()
    }

    /// The rank that was the first to panic.
    pub fn first_failure(&self) -> Option<usize> {
        self.desk().first_failure
    }

    /// Takes a message. Does not wait.
    pub fn send(&self, from: usize, to: usize, message: Message) {
        self.desk().boxes[to][from].push_back(message);
        self.news.notify_all();
    }

    /// Waits for the next message between two ranks. Panics if it will never come.
    pub fn receive(&self, from: usize, to: usize) -> Message {
        let mut desk = self.desk();
        loop {
            if let Some(message) = desk.boxes[to][from].pop_front() {
                desk.activities[to] = Activity::Works;
                return message;
            }
            desk.activities[to] = Activity::WaitsFor(from);
            if let Some(reason) = desk.hopeless(from) {
                drop(desk);
                panic!("rank {to} waits in vain for rank {from}: {reason}");
            }
            desk = self.news.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// A rank has done its work or has `failed`.
    pub fn leave(&self, rank: usize, failed: bool) {
        let mut desk = self.desk();
        desk.activities[rank] = Activity::HasLeft;
        if failed {
            desk.first_failure.get_or_insert(rank);
        }
        self.news.notify_all();
    }

    fn desk(&self) -> MutexGuard<'_, Desk> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Desk {
    /// The reason why a missing message of the rank `from` will never come.
    fn hopeless(&self, from: usize) -> Option<String> {
        if let Some(failed) = self.first_failure {
            return Some(format!("rank {failed} has failed"));
        }
        if self.activities[from] == Activity::HasLeft {
            return Some(format!("rank {from} has ended its work"));
        }
        let blocked = (0..self.activities.len()).all(|rank| self.is_blocked(rank));
        blocked.then(|| "all ranks wait for each other".to_string())
    }

    /// Whether a rank can send nothing before another one sends something.
    fn is_blocked(&self, rank: usize) -> bool {
        match self.activities[rank] {
            Activity::Works => false,
            Activity::WaitsFor(from) => self.boxes[rank][from].is_empty(),
            Activity::HasLeft => true,
        }
    }
}
