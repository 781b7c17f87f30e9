{{- define "hockle.labels" -}}
app.kubernetes.io/name: hockle
app.kubernetes.io/instance: {{ .release }}
app.kubernetes.io/component: {{ .part }}
{{- end }}

{{- define "hockle.name" -}}
{{ printf "%s-%s" .release .part | trunc 63 | trimSuffix "-" }}
{{- end }}

{{/* What every pod is: nobody's rights, nothing written but its volumes. */}}
{{- define "hockle.pod" -}}
automountServiceAccountToken: false
enableServiceLinks: false
securityContext:
  runAsNonRoot: true
  runAsUser: 10001
  runAsGroup: 10001
  fsGroup: 10001
  fsGroupChangePolicy: OnRootMismatch
  seccompProfile: {type: RuntimeDefault}
volumes:
  - {name: data, emptyDir: {}}
  - {name: tmp, emptyDir: {}}
  {{- if .Values.store }}
  - {name: store, persistentVolumeClaim: {claimName: {{ .Values.store }}}}
  {{- end }}
{{- end }}

{{- define "hockle.container" -}}
image: {{ .Values.image.repository }}:{{ .Values.image.tag | default .Chart.AppVersion }}
imagePullPolicy: {{ .Values.image.pullPolicy }}
securityContext:
  allowPrivilegeEscalation: false
  readOnlyRootFilesystem: true
  capabilities: {drop: [ALL]}
envFrom:
  - secretRef: {name: {{ .Values.secret }}}
env:
  - {name: HOCKLE_DATA, value: /data}
  {{- if .Values.store }}
  - {name: HOCKLE_STORE, value: /store}
  {{- end }}
  {{- with .Values.api.host }}
  - {name: HOCKLE_HOSTS, value: {{ . | quote }}}
  {{- end }}
  {{- range $name, $value := .Values.settings }}
  - {name: {{ $name }}, value: {{ $value | quote }}}
  {{- end }}
volumeMounts:
  - {name: data, mountPath: /data}
  - {name: tmp, mountPath: /tmp}
  {{- if .Values.store }}
  - {name: store, mountPath: /store}
  {{- end }}
{{- end }}
