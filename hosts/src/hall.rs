//! A hall: many machines, each asked a few times a second what it does, and nothing else. In: addresses and
//! keys. Out: what each of them says, and for how long it has said nothing. Each question is a greeting with
//! a number of its own, and its answer is to that number: so there is no session, and nothing that was
//! recorded is taken for news.

use std::{
    io::BufRead as _,
    sync::{Arc, Mutex, PoisonError},
    thread::Builder,
    time::Duration,
};

use process::{
    ipc::time::{Moment, sleep_until},
    link::{Watch, Watched},
};

use crate::{
    LinkError,
    hello::{Answer, Identity, Verdict, Wants},
    proof::Role,
    seal::Key,
    talk::{Said, hear, say},
    upper::Caller,
};

/// How often each machine is asked, and what is known is told.
const EVERY: Duration = Duration::from_millis(250);
/// So long an answer may take before the question is put anew, s.
const PATIENT_S: f64 = 0.5;
/// Most bytes of the list of machines.
const MOST_LIST: u64 = 1 << 20;

/// Arguments of a hall.
#[derive(Clone, Debug, clap::Args)]
pub struct HallArgs {
    /// Version of the control on this host.
    #[arg(long, value_name = "VERSION")]
    control: String,
}

/// What is known of a machine, and when it was heard of last.
struct Known(Watched, Moment);

/// Looks at machines until whoever started this is gone.
///
/// # Errors
/// The list or a key cannot be read.
pub fn run(args: &HallArgs) -> Result<(), LinkError> {
    let mut line = Vec::new();
    let mut parent = hear()?;
    let read = std::io::Read::take(&mut parent, MOST_LIST).read_until(b'\n', &mut line);
    read.map_err(|error| LinkError::broken("the list of machines", error))?;
    let list: Vec<Watch> =
        serde_json::from_slice(&line).map_err(|error| LinkError::broken("the list of machines", error))?;
    // Whatever is wrong with a key is said before anybody is called.
    let keys = list.iter().map(|watch| Key::read(&watch.key)).collect::<Result<Vec<_>, _>>()?;
    let mut all = Vec::new();
    for (watch, key) in list.into_iter().zip(keys) {
        let known = Arc::new(Mutex::new(Known(Watched::default(), Moment::now())));
        all.push(Arc::clone(&known));
        let here = Identity::here(&args.control, "");
        let looks = move || looks(&watch.at, key, here, &known);
        Builder::new()
            .name("looks".into())
            .spawn(looks)
            .map_err(|error| LinkError::broken("a thread", error))?;
    }
    let tell = move || {
        loop {
            sleep_until(Moment::now().after(EVERY));
            say(&Said::Machines(all.iter().map(|known| told(known)).collect()));
        }
    };
    Builder::new().name("tells".into()).spawn(tell).map_err(|error| LinkError::broken("a thread", error))?;
    // Until the parent is gone.
    let _ = std::io::copy(&mut parent, &mut std::io::sink());
    std::process::exit(0)
}

fn told(known: &Mutex<Known>) -> Watched {
    let Known(watched, heard) = &*known.lock().unwrap_or_else(PoisonError::into_inner);
    Watched { silent_s: heard.elapsed().as_secs_f64(), ..watched.clone() }
}

/// Asks one machine again and again.
fn looks(at: &str, key: Key, here: Identity, known: &Mutex<Known>) {
    let set =
        |news: &mut dyn FnMut(&mut Known)| news(&mut known.lock().unwrap_or_else(PoisonError::into_inner));
    let mut caller = match Caller::of(key, here, at, Role::Hall) {
        Ok(caller) => caller,
        Err(error) => return set(&mut |known| known.0.why = Some(error.to_string())),
    };
    let mut next = Moment::now();
    loop {
        next = next.after(EVERY);
        let answer = caller.answer(&Wants::Look, PATIENT_S);
        set(&mut |known| match &answer {
            Ok((_, Answer { verdict: Verdict::Seen(seen, age_s), .. })) => {
                let watched = Watched { seen: Some(seen.clone()), age_s: *age_s, ..Watched::default() };
                *known = Known(watched, Moment::now());
            }
            Ok((_, Answer { verdict: Verdict::Refused(text), .. })) => {
                *known = Known(Watched { why: Some(text.clone()), ..Watched::default() }, Moment::now());
            }
            // It is there, and its launcher has not said anything yet.
            Ok(_) => known.1 = Moment::now(),
            Err(LinkError::Refused(text) | LinkError::Input(text)) => {
                *known = Known(Watched { why: Some(text.clone()), ..Watched::default() }, Moment::now());
            }
            // Nobody is there any more who would refuse.
            Err(_) => known.0.why = None,
        });
        if next.passed() {
            next = Moment::now();
        }
        sleep_until(next);
    }
}
