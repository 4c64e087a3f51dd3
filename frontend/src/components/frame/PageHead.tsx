import { Anchor, Breadcrumbs, Group, Title } from "@mantine/core";
import { useDocumentTitle } from "@mantine/hooks";
import type { ReactNode } from "react";

interface Props {
  title: string;
  /** Links from the campaign down to this page's parent. */
  trail?: ReactNode[];
  /** Beside the title: badges. */
  aside?: ReactNode;
  actions?: ReactNode;
}

/** Head of a page: breadcrumbs, title and actions. */
export function PageHead({ title, trail = [], aside, actions }: Props) {
  useDocumentTitle(title === "Start" ? "flexsid" : `${title} · flexsid`);
  return (
    <header>
      {trail.length > 0 && (
        <Breadcrumbs component="nav" aria-label="Breadcrumbs" mb={4} fz="sm" separatorMargin={6}>
          {trail.map((link, index) => (
            <Anchor component="span" key={index} fz="sm" underline="never">
              {link}
            </Anchor>
          ))}
          <span className="quiet" aria-current="page">
            {title}
          </span>
        </Breadcrumbs>
      )}
      <Group justify="space-between" mb="md" gap="sm">
        <Group gap="sm">
          <Title order={1}>{title}</Title>
          {aside}
        </Group>
        <Group gap="xs" className="no-print">
          {actions}
        </Group>
      </Group>
    </header>
  );
}
