//! Sender and receiver of one channel.

use std::{marker::PhantomData, time::Duration};

use iceoryx2::{
    port::{
        BackpressureAction, DegradationAction, SendError, publisher::Publisher, subscriber::Subscriber,
        update_connections::UpdateConnections,
    },
    prelude::{ZeroCopySend, ipc},
    service::port_factory::publish_subscribe::PortFactory,
};

use protocol::Payload;

use super::{
    ChannelCount, IpcError, Keep,
    channel::Channel,
    orphan::{Presence, is_orphan},
    time::Moment,
};

/// So long a channel may be in the making by somebody else before that is an error.
const RETRY: Duration = Duration::from_secs(2);

/// Travels with every message of a channel, counted by its sender from 0.
#[derive(Clone, Copy, Debug, Default, ZeroCopySend)]
#[type_name("pitchlock/running-number/1")]
#[repr(C)]
pub(crate) struct RunningNumber(u64);

/// A process as iceoryx2 sees it.
pub(crate) type Node = iceoryx2::node::Node<ipc::Service>;
/// A channel carries bytes: which type they are stands in its name, and how many there are.
type Service = PortFactory<ipc::Service, [u8], RunningNumber>;

/// The owner's part: a channel exists, with its properties, before anybody opens it.
pub(crate) fn create_service<T: Payload>(
    node: &Node,
    channel: &Channel<T>,
    senders: usize,
    receivers: usize,
) -> Result<Service, IpcError> {
    let name = channel.name();
    node.service_builder(&typed_name::<T>(&name)?)
        .publish_subscribe::<[u8]>()
        .user_header::<RunningNumber>()
        .max_publishers(senders)
        .max_subscribers(receivers)
        .max_nodes(senders + receivers + 1)
        .subscriber_max_buffer_size(channel.depth)
        .subscriber_max_borrowed_samples(1)
        .history_size(0)
        .enable_safe_overflow(channel.keep == Keep::Latest)
        .create()
        .map_err(|error| IpcError::bus(&name, error))
}

/// Opens what the owner made. Only that type and size are the same is asked; the rest is read from the
/// channel.
fn open_service<T: Payload>(node: &Node, name: &str) -> Result<Service, IpcError> {
    use iceoryx2::service::builder::publish_subscribe::PublishSubscribeOpenError as Error;
    let deadline = Moment::now().after(RETRY);
    loop {
        let opened = node
            .service_builder(&typed_name::<T>(name)?)
            .publish_subscribe::<[u8]>()
            .user_header::<RunningNumber>()
            .open();
        match opened {
            // Another process opens or leaves at this moment; a little later all is well.
            Err(Error::HangsInCreation | Error::ServiceInCorruptedState | Error::IsMarkedForDestruction)
                if !deadline.passed() => {}
            other => return other.map_err(|error| IpcError::bus(name, error)),
        }
    }
}

pub(crate) fn service_name(name: &str) -> Result<iceoryx2::prelude::ServiceName, IpcError> {
    format!("pitchlock/{name}").as_str().try_into().map_err(|error| IpcError::bus(name, error))
}

/// Name of a channel, of the type that it carries, with its version, and of its most bytes: ends that differ
/// in any of these do not find each other.
fn typed_name<T: Payload>(name: &str) -> Result<iceoryx2::prelude::ServiceName, IpcError> {
    service_name(&format!("{name}/{}/{}", T::NAME, T::MOST_BYTES))
}

/// An end of a channel that must find its other end before the machine starts.
pub trait Port {
    /// Name of the channel or event.
    fn name(&self) -> &str;

    /// Whether everybody is there and mapped. Before that, a lossless channel would lose messages in silence.
    ///
    /// # Errors
    /// If the other end is there, but cannot be connected to.
    fn connected(&self) -> Result<bool, IpcError>;
}

/// How long a sender waits for a place in a full queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Patience {
    /// As long as the receiver and the launcher live (virtual time; the launcher watches).
    Forever,
    /// At most so long (real time).
    Bounded(Duration),
}

/// A message was not delivered to everybody.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Undelivered {
    /// A queue stayed full for as long as the sender's patience lasted.
    #[error("{0}: the queue stayed full")]
    Full(String),
    /// Receivers have gone.
    #[error("{name}: {reached} of {expected} receivers reached")]
    Receivers {
        /// Channel.
        name: String,
        /// How many got the message.
        reached: usize,
        /// How many should have.
        expected: usize,
    },
    /// iceoryx2 could not send.
    #[error("{name}: {reason}")]
    Broken {
        /// Channel.
        name: String,
        /// In the words of iceoryx2.
        reason: String,
    },
}

/// The sending end of a channel.
#[derive(Debug)]
pub struct Sender<T: Payload> {
    service: Service,
    publisher: Publisher<ipc::Service, [u8], RunningNumber>,
    expected: usize,
    next: RunningNumber,
    count: ChannelCount,
    message: PhantomData<fn(T)>,
    _presence: Option<Presence>,
}

impl<T: Payload> Sender<T> {
    pub(crate) fn open(node: &Node, channel: Channel<T>, patience: Patience) -> Result<Sender<T>, IpcError> {
        let name = channel.name();
        let service = open_service::<T>(node, &name)?;
        let builder =
            service.publisher_builder().max_loaned_samples(1).set_degradation_handler(fail_if_degraded);
        let builder = builder.initial_max_slice_len(T::MOST_BYTES);
        let builder = match patience {
            // Nobody frees the queue of a launcher that is gone.
            Patience::Forever => builder.set_backpressure_handler(|_| match is_orphan() {
                false => BackpressureAction::Retry,
                true => BackpressureAction::DiscardDataAndFail,
            }),
            Patience::Bounded(limit) => {
                builder.set_backpressure_handler(move |full| match full.elapsed_time < limit {
                    true => BackpressureAction::Retry,
                    false => BackpressureAction::DiscardDataAndFail,
                })
            }
        };
        let publisher = builder.create().map_err(|error| IpcError::bus(&name, error))?;
        let expected = static_config(&service).max_subscribers();
        let count = ChannelCount { name, ..ChannelCount::default() };
        let (next, message) = (RunningNumber(0), PhantomData);
        Ok(Sender { service, publisher, expected, next, count, message, _presence: None })
    }

    /// As long as this end is open, its process lives in the name space.
    pub(crate) fn within(self, presence: Option<Presence>) -> Sender<T> {
        Sender { _presence: presence, ..self }
    }

    /// Puts a message into the queue of every receiver.
    ///
    /// # Errors
    /// [`Undelivered`] if that did not succeed for every receiver; others may have got it.
    pub fn send(&mut self, message: &T) -> Result<(), Undelivered> {
        let broken = |error: SendError| match error {
            SendError::UnableToDeliver => Undelivered::Full(self.count.name.clone()),
            other => Undelivered::Broken { name: self.count.name.clone(), reason: other.to_string() },
        };
        let bytes = message.bytes();
        let mut sample =
            self.publisher.loan_slice_uninit(bytes.len()).map_err(|error| broken(error.into()))?;
        *sample.user_header_mut() = self.next;
        self.next.0 += 1;
        let reached = sample.write_from_slice(bytes).send().map_err(broken)?;
        self.count.sent += reached as u64;
        self.count.bytes += (reached * bytes.len()) as u64;
        if reached < self.expected {
            let (name, expected) = (self.count.name.clone(), self.expected);
            return Err(Undelivered::Receivers { name, reached, expected });
        }
        Ok(())
    }

    /// The message that nobody took comes again, so it keeps its number: no gap, nothing that was lost.
    pub fn comes_again(&mut self) {
        self.next.0 = self.next.0.saturating_sub(1);
    }

    /// One receiver has died, and the machine goes on without it.
    pub fn expect_one_less(&mut self) {
        self.expected = self.expected.saturating_sub(1);
    }

    /// What was sent so far.
    pub fn count(&self) -> ChannelCount {
        self.count.clone()
    }
}

impl<T: Payload> Port for Sender<T> {
    fn name(&self) -> &str {
        &self.count.name
    }

    fn connected(&self) -> Result<bool, IpcError> {
        let here = dynamic_config(&self.service).number_of_subscribers();
        self.publisher.update_connections().map_err(|error| IpcError::bus(self.name(), error))?;
        Ok(here == self.expected)
    }
}

/// The receiving end of a channel.
#[derive(Debug)]
pub struct Receiver<T: Payload> {
    service: Service,
    subscriber: Subscriber<ipc::Service, [u8], RunningNumber>,
    expected: usize,
    keep: Keep,
    next: RunningNumber,
    count: ChannelCount,
    message: PhantomData<fn() -> T>,
    _presence: Option<Presence>,
}

impl<T: Payload> Receiver<T> {
    pub(crate) fn open(node: &Node, channel: Channel<T>) -> Result<Receiver<T>, IpcError> {
        let name = channel.name();
        let service = open_service::<T>(node, &name)?;
        let subscriber = service
            .subscriber_builder()
            .buffer_size(channel.depth)
            .set_degradation_handler(fail_if_degraded)
            .create()
            .map_err(|error| IpcError::bus(&name, error))?;
        let expected = static_config(&service).max_publishers();
        let count = ChannelCount { name, ..ChannelCount::default() };
        let (keep, next) = (channel.keep, RunningNumber(0));
        Ok(Receiver {
            service,
            subscriber,
            expected,
            keep,
            next,
            count,
            message: PhantomData,
            _presence: None,
        })
    }

    /// As long as this end is open, its process lives in the name space.
    pub(crate) fn within(self, presence: Option<Presence>) -> Receiver<T> {
        Receiver { _presence: presence, ..self }
    }

    /// The oldest message that waits, if any.
    ///
    /// # Errors
    /// [`IpcError::Bus`] if the channel is broken.
    pub fn receive(&mut self) -> Result<Option<T>, IpcError> {
        let received = self.subscriber.receive().map_err(|error| IpcError::bus(&self.count.name, error))?;
        let Some(sample) = received else { return Ok(None) };
        self.count.received += 1;
        // A value that a newer one replaced is not lost.
        if self.expected == 1 && self.keep == Keep::Every {
            let number = sample.user_header().0;
            self.count.lost += number.saturating_sub(self.next.0);
            self.next = RunningNumber(number + 1);
        }
        let message = T::from_payload(sample.payload());
        message.map(Some).ok_or_else(|| IpcError::bus(&self.count.name, "a message of another size"))
    }

    /// What was received and missed so far.
    pub fn count(&self) -> ChannelCount {
        self.count.clone()
    }
}

impl<T: Payload> Port for Receiver<T> {
    fn name(&self) -> &str {
        &self.count.name
    }

    fn connected(&self) -> Result<bool, IpcError> {
        let here = dynamic_config(&self.service).number_of_publishers();
        self.subscriber.update_connections().map_err(|error| IpcError::bus(self.name(), error))?;
        Ok(here == self.expected)
    }
}

// A connection that cannot be made is an error; the default is a line in a log.
fn fail_if_degraded(
    _: iceoryx2::port::DegradationCause,
    _: &iceoryx2::port::DegradationInfo,
) -> DegradationAction {
    DegradationAction::DegradeAndFail
}

fn static_config(service: &Service) -> &iceoryx2::service::static_config::publish_subscribe::StaticConfig {
    use iceoryx2::service::port_factory::PortFactory as _;
    service.static_config()
}

fn dynamic_config(
    service: &Service,
) -> &iceoryx2::service::dynamic_config::publish_subscribe::DynamicConfig<
    <ipc::Service as iceoryx2::service::Service>::Bag,
> {
    use iceoryx2::service::port_factory::PortFactory as _;
    service.dynamic_config()
}
