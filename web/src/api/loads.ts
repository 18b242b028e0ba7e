import { answerOf, api, askBytes } from "./client";
import type { Background } from "./computations";
import type { Api } from "./types";

type LineKindName = Api<"LineKindName">;

const of = (study: string, line: LineKindName) => ({ params: { path: { study, line } } });

const path = (study: string, line: LineKindName): string =>
  `/api/studies/${encodeURIComponent(study)}/loads/${line}`;

/** Loads that are possible on the model of a line of action. */
export const readLoadMenu = (study: string, line: LineKindName, signal: AbortSignal) =>
  answerOf(api.GET("/api/studies/{study}/loads/{line}", { ...of(study, line), signal }));

/** The model under the loads of a file, which is sent unchanged. */
export const simulateLoads = (
  study: string,
  line: LineKindName,
  file: string,
  signal: AbortSignal,
) =>
  answerOf(
    api.POST("/api/studies/{study}/loads/{line}", {
      ...of(study, line),
      // The program reads the text itself, so that its messages name lines of the file.
      body: {} as Api<"LoadFile">,
      bodySerializer: () => file,
      signal,
    }),
  );

/** The file of the model, as `spineline simulate` reads it. */
export const modelFilePath = (study: string, line: LineKindName): string =>
  `${path(study, line)}/model`;

/** The file of a simulation. */
export const askSimulationFile = (
  study: string,
  line: LineKindName,
  file: string,
  signal: AbortSignal,
): Promise<Response> =>
  askBytes(`${path(study, line)}/simulation`, signal, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: file,
  });

/** Intervals of the model under the loads of a file, with this number of replicates. */
export function loadIntervalsOf(
  study: string,
  line: LineKindName,
  file: () => string,
  count: number,
): Background<Api<"LoadIntervalsView">> {
  const address = "/api/studies/{study}/loads/{line}/intervals";
  return {
    read: () => answerOf(api.GET(address, of(study, line))),
    begin: () => answerOf(api.POST(address, { ...of(study, line), body: { count, file: file() } })),
    cancel: () => answerOf(api.DELETE(address, of(study, line))),
  };
}

/** The pads that were tried on the current results. */
export const readPadMap = (study: string, line: LineKindName) =>
  answerOf(api.GET("/api/studies/{study}/loads/{line}/pad-map", of(study, line)));

/** Tries pads in the background. */
export const computePadMap = (study: string, line: LineKindName, body: Api<"PadMapRequest">) =>
  answerOf(api.POST("/api/studies/{study}/loads/{line}/pad-map", { ...of(study, line), body }));

export const cancelPadMap = (study: string, line: LineKindName) =>
  answerOf(api.DELETE("/api/studies/{study}/loads/{line}/pad-map", of(study, line)));
