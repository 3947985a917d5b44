//! Two hosts: the interpreter on one, the machine on the other. Over loopback where that is enough; where a
//! cable is cut or frames are lost, in two network namespaces, which need an administrator.

mod cables;
mod gate;
mod hall;
mod halves;
mod killed;
mod licences;
mod mutations;
mod panel;
mod place;
mod refusals;
mod relay;
mod room;
mod rude;
