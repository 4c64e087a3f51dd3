import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { designsQuery } from "../api/queries";
import type { Design } from "../api/types";
import { DataTable, numeric, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { PageHead } from "../components/frame/PageHead";
import { Loaded } from "../components/display/Loaded";
import { Section } from "../components/display/Section";
import { bandOf } from "../lib/designDraft";
import { dateTime, fixed } from "../lib/format";

const COLUMNS: Column<Design>[] = [
  {
    key: "name",
    header: "Design",
    render: (design) => (
      <Link
        to="/excitation/$id"
        params={{ id: design.id }}
        search={{ tab: "preflight-simulation" }}
        className="link"
      >
        {design.name}
      </Link>
    ),
  },
  numeric("duration", "Duration", (design) => fixed(design.specification.duration_s, 1), "s"),
  { key: "band", header: "Band", unit: "Hz", numeric: true, render: bandOf },
  { key: "at", header: "Created", numeric: true, render: (design) => dateTime(design.created_at) },
];

/** Designs of excitation, each with a link to its pre-flight simulations. */
export function PreflightPage() {
  const designs = useQuery(designsQuery);
  return (
    <>
      <PageHead title="Pre-flight simulation" />
      <Section
        title="Designs"
        note="Simulated flight of a design with the model of a run, with or without a controller"
      >
        <Loaded query={designs} rows={6}>
          {(rows) =>
            rows.length === 0 ? (
              <Empty title="No designs yet">
                Design an excitation under{" "}
                <Link to="/excitation" className="link">
                  Excitation
                </Link>{" "}
                first.
              </Empty>
            ) : (
              <DataTable
                label="Designs"
                testId="preflight-table"
                columns={COLUMNS}
                rows={rows}
                rowKey={(design) => design.id}
              />
            )
          }
        </Loaded>
      </Section>
    </>
  );
}
