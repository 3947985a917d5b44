//! Places at the gate: for those who have proved nothing, and apart from them for those who have. In: who
//! comes and who goes. Out: who has to go for somebody new. Neither strangers nor halls take a place of those
//! who operate the machine.

use std::{
    net::IpAddr,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering::Relaxed},
    },
};

use crate::proof::Role;

/// Those who have proved nothing, at once.
pub const STRANGERS: usize = 16;
/// Halls at once.
pub const HALLS: usize = 16;
/// Those at once who run programs, stand at the machine or measure.
pub const OPERATORS: usize = 8;

/// Who goes for somebody new, of strangers in the order in which they came: the oldest of the address that
/// has most of them. So whoever comes alone from his address is pushed out by nobody who comes often.
pub fn goes(strangers: impl Iterator<Item = IpAddr> + Clone) -> Option<usize> {
    let from = |address| strangers.clone().filter(|other| *other == address).count();
    let most = strangers.clone().map(from).max()?;
    strangers.clone().position(|address| from(address) == most)
}

/// Places of those who have proved what they are.
#[derive(Clone, Debug, Default)]
pub struct Places(Arc<[AtomicUsize; 2]>);

impl Places {
    /// One of them, if there is any.
    pub fn take(&self, role: Role) -> Option<Place> {
        let (of, most) = if role == Role::Hall { (0, HALLS) } else { (1, OPERATORS) };
        let more = |taken: usize| (taken < most).then_some(taken + 1);
        self.0[of].fetch_update(Relaxed, Relaxed, more).ok().map(|_| Place(Arc::clone(&self.0), of))
    }
}

/// A place that is taken. It is free again with this.
#[derive(Debug)]
pub struct Place(Arc<[AtomicUsize; 2]>, usize);

impl Drop for Place {
    fn drop(&mut self) {
        self.0[self.1].fetch_sub(1, Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(last: u8) -> IpAddr {
        IpAddr::from([10, 0, 0, last])
    }

    #[test]
    fn the_oldest_of_those_who_are_many_goes() {
        let of = |all: &[u8]| goes(all.iter().map(|last| address(*last)));
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[1, 2, 3]), Some(0), "each is alone: the oldest");
        assert_eq!(of(&[9, 1, 2, 1, 1, 2]), Some(1));
        // Somebody comes again and again: who came alone before him stays.
        let mut all = vec![7, 9];
        for _ in 0..1000 {
            if all.len() == STRANGERS {
                all.remove(of(&all).expect("some"));
            }
            all.push(1);
        }
        assert_eq!((all[..2].to_vec(), all.len()), (vec![7, 9], STRANGERS));
    }

    #[test]
    fn halls_take_their_own_places_and_each_is_free_again() {
        let places = Places::default();
        let halls: Vec<_> = (0..20).filter_map(|_| places.take(Role::Hall)).collect();
        let mut operators: Vec<_> = (0..20).filter_map(|_| places.take(Role::Operator)).collect();
        assert_eq!((halls.len(), operators.len()), (HALLS, OPERATORS));
        drop(operators.pop());
        assert!(places.take(Role::Operator).is_some() && places.take(Role::Hall).is_none());
    }
}
