import { Button, Menu } from "@mantine/core";
import { address, type QueryValue } from "../api/client";

interface Props {
  /** What is reported: run/3, comparison, campaign. */
  of: string;
  query?: Record<string, QueryValue>;
}

/** Download of a page as one report file. */
export function ReportMenu({ of, query }: Props) {
  const forms = { html: "Web page with interactive figures", pdf: "PDF" } as const;
  return (
    <Menu position="bottom-end">
      <Menu.Target>
        <Button variant="default" data-testid="report">
          Report
        </Button>
      </Menu.Target>
      <Menu.Dropdown>
        {(["html", "pdf"] as const).map((format) => (
          <Menu.Item
            key={format}
            component="a"
            href={address(`reports/${of}`, { ...query, format })}
            target="_blank"
            rel="noopener"
            data-testid={`report-${format}`}
          >
            {forms[format]}
          </Menu.Item>
        ))}
      </Menu.Dropdown>
    </Menu>
  );
}
