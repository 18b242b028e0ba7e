import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";

const uid = (value: string) => ({ vr: "UI", Value: [value] });

const series = (patient: string) => [
  {
    "0020000D": uid("1.2"),
    "0020000E": uid("1.2.3"),
    "00080020": { vr: "DA", Value: ["20240517"] },
    "00080060": { vr: "CS", Value: ["DX"] },
    "00081030": { vr: "LO", Value: ["Whole spine standing"] },
    "00201209": { vr: "IS", Value: [2] },
    "00100020": { vr: "LO", Value: [patient] },
  },
];

const films = ["1.2.3.4", "1.2.3.5"].map((instance, index) => ({
  "00080018": uid(instance),
  "00200013": { vr: "IS", Value: [index + 1] },
  "00280010": { vr: "US", Value: [900] },
  "00280011": { vr: "US", Value: [400] },
}));

/** A DICOMweb server with one series of two films, of which it has lost the second; the patient `locked` is refused. */
export async function startArchive(film: Buffer): Promise<{ address: string; server: Server }> {
  const server = createServer((request, response) => {
    const { pathname, searchParams } = new URL(request.url ?? "", "http://archive");
    const patient = searchParams.get("PatientID");
    const json = (body: unknown) =>
      response.setHeader("content-type", "application/dicom+json").end(JSON.stringify(body));
    if (patient === "locked") response.writeHead(401).end();
    else if (pathname.endsWith("/dicom-web/series"))
      json(patient === "P-07" ? series(patient) : []);
    else if (pathname.endsWith("/instances")) json(films);
    else if (pathname.endsWith("/instances/1.2.3.4"))
      response
        .setHeader("content-type", 'multipart/related; type="application/dicom"; boundary=b')
        .end(
          Buffer.concat([
            Buffer.from("--b\r\nContent-Type: application/dicom\r\n\r\n"),
            film,
            Buffer.from("\r\n--b--\r\n"),
          ]),
        );
    else response.writeHead(404).end();
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address() as AddressInfo;
  return { address: `http://127.0.0.1:${port}/dicom-web`, server };
}
