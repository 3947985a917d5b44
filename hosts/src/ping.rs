//! The way there and back, measured with messages of the size of machine code. In: how many, how often. Out:
//! a table.

use std::{fmt::Write as _, time::Duration};

use process::ipc::time::{Moment, sleep_until};
use protocol::{CodePacket, Credit, Payload as _};

use crate::{
    LinkError,
    hello::Wants,
    message::Message,
    upper::{CallArgs, Caller},
    wire::Event,
};

/// Arguments of the measurement.
#[derive(Clone, Debug, clap::Args)]
pub struct PingArgs {
    #[command(flatten)]
    call: CallArgs,
    /// How many messages of each size.
    #[arg(long, value_name = "N", default_value_t = 1000)]
    count: u64,
    /// One so often, µs.
    #[arg(long, value_name = "US", default_value_t = 2000)]
    every_us: u64,
}

/// So long after the last one it is waited for those that have not come.
const LAST: Duration = Duration::from_secs(2);

/// So long at most nothing is looked at while some are to be sent, and behind the last one.
const SHORT_NAP: Duration = Duration::from_millis(1);
const NAP: Duration = Duration::from_millis(10);
/// Between two sizes.
const PAUSE: Duration = Duration::from_millis(20);

/// The times of one size, sorted, µs.
struct Row {
    bytes: usize,
    sent: u64,
    times_us: Vec<f64>,
}

impl Row {
    /// The time that this share of those that came back needed at most.
    fn share(&self, share: f64) -> f64 {
        let last = self.times_us.len().saturating_sub(1);
        self.times_us.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
    }
}

/// Measures, and prints the table.
///
/// # Errors
/// [`LinkError`].
pub fn run(args: &PingArgs) -> Result<(), LinkError> {
    let mut caller = Caller::new(&args.call)?;
    let (_, mut session) = caller.call(&Wants::Ping, 5.0)?;
    let mut text = String::new();
    let measured = measure(args, &caller, &mut session, &mut text);
    // What was measured until then is shown.
    crate::talk::print(&text);
    measured
}

/// Writes the table, row by row.
fn measure(
    args: &PingArgs,
    caller: &Caller,
    session: &mut crate::session::Session,
    text: &mut String,
) -> Result<(), LinkError> {
    text.push_str("| bytes | sent | median µs | 99 % µs | most µs | lost |\n|---|---|---|---|---|---|\n");
    for bytes in [size_of::<Credit>(), 256, CodePacket::MOST_BYTES] {
        let mut row = Row { bytes, sent: args.count, times_us: Vec::new() };
        let (begun, mut next) = (Moment::now(), Moment::now());
        let mut sent = 0;
        let mut deadline = Moment::now().after(LAST);
        while (row.times_us.len() as u64) < args.count && !deadline.passed() {
            session.lives()?;
            if sent < args.count && next.passed() {
                let mut body = vec![0; bytes.max(8)];
                body[..8].copy_from_slice(&(begun.elapsed().as_nanos() as u64).to_le_bytes());
                session.voice.say(&Message::Ping(body))?;
                sent += 1;
                next = next.after(Duration::from_micros(args.every_us));
                deadline = Moment::now().after(LAST);
            }
            if sent < args.count {
                // It is woken by what comes, and else in time for the next one.
                let left = next.since(Moment::now()).min(SHORT_NAP);
                note(caller.wire.wait(left), session, begun, &mut row)?;
            } else {
                note(caller.wire.wait(NAP), session, begun, &mut row)?;
            }
        }
        row.times_us.sort_by(f64::total_cmp);
        let lost = row.sent - row.times_us.len() as u64;
        let _ = writeln!(
            text,
            "| {} | {} | {:.0} | {:.0} | {:.0} | {lost} |",
            row.bytes,
            row.sent,
            row.share(0.5),
            row.share(0.99),
            row.share(1.0)
        );
        sleep_until(Moment::now().after(PAUSE));
    }
    Ok(())
}

/// Notes what came back.
fn note(
    event: Option<Event>,
    session: &mut crate::session::Session,
    begun: Moment,
    row: &mut Row,
) -> Result<(), LinkError> {
    let frame = match event {
        Some(Event::Frame(frame)) => frame,
        Some(Event::Gone) => {
            session.is_cut();
            return Ok(());
        }
        _ => return Ok(()),
    };
    if let Some(Message::Pong(body)) = session.hear(&frame)?
        && let Some((stamp, _)) = body.split_first_chunk()
    {
        let now = begun.elapsed().as_nanos() as u64;
        row.times_us.push(now.saturating_sub(u64::from_le_bytes(*stamp)) as f64 / 1e3);
    }
    Ok(())
}
