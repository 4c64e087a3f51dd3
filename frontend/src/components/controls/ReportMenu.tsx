import { Button, Menu, Modal } from "@mantine/core";
import { useState } from "react";
import { address, type QueryValue } from "../../api/client";
import { usePrintReport } from "../../api/commands";
import type { Job } from "../../api/types";
import { useUnitParameters } from "../../api/units";
import { JobWait } from "../jobs/JobWait";
import { ProblemAlert } from "../display/ProblemAlert";

interface Props {
  /** What is reported: run/3, comparison, campaign. */
  of: string;
  query?: Record<string, QueryValue>;
}

/** Download of a page as one report in display units: at once as a web page, or printed as a PDF. */
export function ReportMenu({ of, query }: Props) {
  const print = usePrintReport();
  const path = address(`reports/${of}`, { ...query, ...useUnitParameters() });
  return (
    <>
      <Menu position="bottom-end">
        <Menu.Target>
          <Button variant="default" data-testid="report">
            Report
          </Button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Item
            component="a"
            href={path}
            target="_blank"
            rel="noopener"
            data-testid="report-html"
          >
            Web page with interactive figures
          </Menu.Item>
          <Menu.Item
            data-testid="report-pdf"
            onClick={() => {
              print.mutate(path);
            }}
          >
            PDF
          </Menu.Item>
        </Menu.Dropdown>
      </Menu>
      <PrintedPdf print={print} title="PDF report" />
    </>
  );
}

/** The job that prints a PDF, which can be cancelled, and the file when it has ended. */
export function PrintedPdf({
  print,
  title,
}: {
  print: ReturnType<typeof usePrintReport>;
  title: string;
}) {
  const [ended, setEnded] = useState<Job>();
  const job = print.data;
  return (
    <Modal opened={!print.isIdle} onClose={print.reset} title={title}>
      {print.isError && <ProblemAlert error={print.error} />}
      {job !== undefined && <JobWait id={job.id} onEnd={setEnded} />}
      {ended?.state === "succeeded" && ended.id === job?.id && (
        <Button
          component="a"
          href={printedReport(ended.id)}
          target="_blank"
          rel="noopener"
          data-testid="open-report"
        >
          Open PDF
        </Button>
      )}
    </Modal>
  );
}

/** Address of the PDF that a job has printed. */
export function printedReport(jobId: number): string {
  return address(`reports/files/${jobId}`);
}
