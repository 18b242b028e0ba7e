// Tests run outside of a browser, and requests need the address of a page.
globalThis.location = new URL("http://127.0.0.1:8765/") as unknown as Location;
