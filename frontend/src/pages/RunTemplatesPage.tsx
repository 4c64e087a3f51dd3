import { Button } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useDeleteTemplate } from "../api/commands";
import { aircraftQuery, runTemplatesQuery } from "../api/queries";
import type { RunTemplate } from "../api/types";
import { DataTable, type Column } from "../components/controls/DataTable";
import { Empty } from "../components/display/Empty";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { settingsText } from "../components/new-run/runRequest";
import { dateMinute } from "../lib/text/format";

/** Templates of runs of all campaigns: settings under a name. */
export function RunTemplatesPage() {
  const templates = useQuery(runTemplatesQuery());
  const aircraft = useQuery(aircraftQuery);
  const remove = useDeleteTemplate();
  const columns: Column<RunTemplate>[] = [
    { key: "name", header: "Name", render: (one) => one.name, yields: true },
    { key: "method", header: "Method", render: (one) => one.method },
    {
      key: "settings",
      header: "Settings",
      wraps: true,
      render: (one) => settingsText(one.settings),
    },
    { key: "note", header: "Note", wraps: true, render: (one) => one.note },
    { key: "revision", header: "Revision", numeric: true, render: (one) => one.revision },
    { key: "author", header: "By", render: (one) => one.author },
    { key: "at", header: "Saved", render: (one) => dateMinute(one.created_at) },
    {
      key: "aircraft",
      header: "Aircraft",
      render: (one) => aircraft.data?.find(({ id }) => id === one.aircraft_id)?.name ?? "",
    },
    {
      key: "delete",
      header: "",
      render: (one) => (
        <Button
          variant="subtle"
          size="compact-sm"
          color="red"
          aria-label={`Delete template ${one.name}`}
          onClick={() => {
            remove.mutate(one);
          }}
        >
          Delete
        </Button>
      ),
    },
  ];
  return (
    <>
      <PageHead
        title="Templates of runs"
        trail={[
          <Link to="/runs" className="link" key="runs">
            Runs
          </Link>,
        ]}
      />
      {remove.isError && <ProblemAlert error={remove.error} />}
      <div className="panel">
        <Loaded query={templates}>
          {(all) =>
            all.length === 0 ? (
              <Empty title="No templates">
                Save the settings of a run by Save as template on its page; new runs and batches
                then offer them.
              </Empty>
            ) : (
              <DataTable
                label="Templates of runs"
                testId="run-templates"
                columns={columns}
                rows={all}
                rowKey={(one) => one.id}
              />
            )
          }
        </Loaded>
      </div>
    </>
  );
}
