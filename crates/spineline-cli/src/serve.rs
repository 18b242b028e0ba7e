//! `spineline serve`: the browser app on this machine.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use chrono::Utc;
use clap::Args;
use spineline_server::http::api::AccessName;
use spineline_server::http::{ServeOptions, Server};
use spineline_server::store::{Name, Signature, Store};

use crate::failure::{Ending, Failure};
use crate::print;

/// Start the browser app
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Store of studies; made if it is not there
    #[arg(default_value = "studies.spineline", value_name = "STORE")]
    store: PathBuf,

    /// Port on this machine; 0 takes a free one
    #[arg(long, default_value_t = 0)]
    port: u16,
}

pub fn run(args: &ServeArgs) -> Result<Ending, Failure> {
    let fail = |error| Failure::store(&args.store, &error);
    let store = if args.store.exists() {
        Store::open(&args.store).map_err(fail)?
    } else {
        let by = Signature::new(Name::new("serve").map_err(fail)?, Utc::now().into());
        Store::create(&args.store, &by).map_err(fail)?
    };
    let decoder = std::env::current_exe()
        .map_err(|error| Failure::internal(format!("this program cannot find itself: {error}")))?;
    let options = ServeOptions {
        decoder,
        decoder_arguments: vec!["decode-film".to_owned()],
        access: AccessName::Token,
        hosts: Vec::new(),
        https: false,
    };
    let address = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), args.port);
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| Failure::internal(error.to_string()))?;
    runtime.block_on(async {
        let server = Server::bind(store, address, options)
            .await
            .map_err(|error| Failure::input(&address.to_string(), &error, "try another --port"))?;
        print(&format!("{}\n", server.address_to_open()))?;
        let end = async { tokio::signal::ctrl_c().await.unwrap_or_default() };
        server.run(end).await.map_err(|error| Failure::internal(error.to_string()))?;
        Ok(Ending::Done)
    })
}
