import { Button, Group, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi, Link } from "@tanstack/react-router";
import { useRef, useState, type DragEvent } from "react";
import { useDeleteUpload, useSaveDraft, useUploadFiles } from "../api/commands";
import { draftsQuery, uploadQuery } from "../api/queries";
import { ButtonLink } from "../components/controls/ButtonLink";
import { DataTable } from "../components/controls/DataTable";
import { ImportMapping } from "../components/imports/ImportMapping";
import { Loaded } from "../components/display/Loaded";
import { PageHead } from "../components/frame/PageHead";
import { ProblemAlert } from "../components/display/ProblemAlert";
import { Section } from "../components/display/Section";
import { dateTime } from "../lib/text/format";

const route = getRouteApi("/import");

/** Import page: upload of files, mapping of their columns, import. */
export function ImportPage() {
  const { upload } = route.useSearch();
  return (
    <>
      <PageHead
        title="Import"
        trail={[
          <Link key="campaign" to="/campaign" className="link">
            Campaign
          </Link>,
        ]}
        actions={
          upload !== undefined && (
            <ButtonLink variant="default" to="/import" search={{}}>
              Other files
            </ButtonLink>
          )
        }
      />
      {upload === undefined ? (
        <Stack gap="md">
          <DropFiles />
          <UnfinishedImports />
        </Stack>
      ) : (
        <Uploaded key={upload} id={upload} />
      )}
    </>
  );
}

function Uploaded({ id }: { id: string }) {
  const upload = useQuery(uploadQuery(id));
  return (
    <Loaded query={upload} rows={8}>
      {(found) => <ImportMapping found={found} />}
    </Loaded>
  );
}

/** Own uploads that are not imported, to go on in any browser. */
function UnfinishedImports() {
  const drafts = useQuery(draftsQuery);
  const remove = useDeleteUpload();
  return (
    <Section title="Unfinished imports" note="Own uploads, stored for 7 days">
      <Loaded query={drafts} rows={2}>
        {(found) =>
          found.length === 0 ? (
            <Text size="sm" className="quiet">
              None.
            </Text>
          ) : (
            <DataTable
              label="Unfinished imports"
              columns={[
                {
                  key: "files",
                  header: "Files",
                  yields: true,
                  render: (one) => (
                    <Link to="/import" search={{ upload: one.id }} className="link">
                      {one.files.join(", ")}
                    </Link>
                  ),
                },
                { key: "changed", header: "Changed", render: (one) => dateTime(one.changed_at) },
                {
                  key: "delete",
                  header: "",
                  render: (one) => (
                    <Button
                      variant="subtle"
                      size="compact-xs"
                      aria-label={`Delete the upload of ${one.files.join(", ")}`}
                      loading={remove.isPending && remove.variables === one.id}
                      onClick={() => {
                        remove.mutate(one.id);
                      }}
                    >
                      Delete
                    </Button>
                  ),
                },
              ]}
              rows={found}
              rowKey={(one) => one.id}
            />
          )
        }
      </Loaded>
      {remove.isError && <ProblemAlert error={remove.error} />}
    </Section>
  );
}

function DropFiles() {
  const navigate = route.useNavigate();
  const send = useUploadFiles();
  const saveDraft = useSaveDraft();
  const chooser = useRef<HTMLInputElement>(null);
  const [over, setOver] = useState(false);

  const take = async (selected: File[]) => {
    const mapping = selected.find((file) => file.name.toLowerCase().endsWith(".toml"));
    const files = selected.filter((file) => file !== mapping);
    if (files.length === 0) return;
    const text = await mapping?.text();
    send.mutate(files, {
      onSuccess: ({ upload }) => {
        const open = () => void navigate({ search: { upload: upload.id } });
        if (text === undefined) open();
        else saveDraft.mutate({ id: upload.id, mapping: text }, { onSuccess: open });
      },
    });
  };
  const drop = (event: DragEvent) => {
    event.preventDefault();
    setOver(false);
    void take([...event.dataTransfer.files]);
  };

  return (
    <Section
      title="Recorder files"
      note="CSV, TSV and fixed-width text, MATLAB, HDF5, NetCDF-4, NumPy, Parquet, MDF4, TDMS, IRIG 106 Chapter 10, ULog and DataFlash. Nothing is stored before you confirm the contents."
    >
      <Stack gap="md">
        <div
          className="drop-zone"
          data-over={over}
          onDragOver={(event) => {
            event.preventDefault();
            setOver(true);
          }}
          onDragLeave={() => {
            setOver(false);
          }}
          onDrop={drop}
        >
          <input
            ref={chooser}
            type="file"
            multiple
            hidden
            aria-label="Recorder files"
            data-testid="import-files"
            onChange={(event) => {
              void take([...(event.currentTarget.files ?? [])]);
              event.currentTarget.value = "";
            }}
          />
          <Text fw={600}>Drop the files of one flight or maneuver here</Text>
          <Text size="sm" className="quiet">
            Files of several recorders and a mapping (.toml) can be imported together.
          </Text>
          <Group justify="center" mt="sm">
            <Button
              loading={send.isPending}
              onClick={() => chooser.current?.click()}
              data-testid="choose-files"
            >
              Select files
            </Button>
          </Group>
        </div>
        {send.isError && (
          <>
            <ProblemAlert error={send.error} />
            <Text size="sm" className="quiet">
              Nothing was stored.
            </Text>
          </>
        )}
      </Stack>
    </Section>
  );
}
