import { mount } from "svelte";

import App from "./App.svelte";
import "./theme/tokens.css";
import "./theme/base.css";
import "./theme/print.css";

const target = document.getElementById("app");
if (!target) throw new Error("the page has no element with the id app");

export default mount(App, { target });
