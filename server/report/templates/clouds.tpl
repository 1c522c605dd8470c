{{%AUTOESCAPE context="HTML"}}
<section class="card">
<h2 id="clouds" data-part="Clouds">Coloured clouds <span class="soft">every point in the colours of the cameras that see it</span></h2>
{{#CLOUD}}
<h3>{{LIDAR}} <span class="soft">capture {{CAPTURE}}: {{SHARE}}</span></h3>
<div class="pictures clouds">
{{#VIEW}}
<figure><a href="{{FILE}}"><img loading="lazy" decoding="async" src="{{FILE}}" alt="{{ALT}}"></a><figcaption>{{NAME}}</figcaption></figure>
{{/VIEW}}
</div>
<p class="hint">Green points are seen by none of these cameras. <a class="screen" href="{{PLY}}" download>The cloud as PLY</a></p>
{{/CLOUD}}
{{#OVERLAYS}}
<h3>The cloud in each camera's picture <span class="soft">coloured by distance</span></h3>
<p class="hint lead">Look at the edges of things: there the points must change colour. If they are shifted by the same everywhere, the rotation is wrong; if more for near things, the position. Yellow is near, violet far; the scale in metres is in the lower left corner of each picture.</p>
<div class="pictures clouds overlays">
{{#OVERLAY}}
<figure><a href="{{FILE}}"><img loading="lazy" decoding="async" src="{{FILE}}"{{#SIZE}} width="{{WIDTH}}" height="{{HEIGHT}}"{{/SIZE}} alt="{{LIDAR}} in the picture of {{CAMERA}}"></a><figcaption><strong>{{CAMERA}}</strong>, capture {{CAPTURE}}: {{POINTS}} of {{LIDAR}}<span class="screen">. Large: <a href="{{FILE}}">with the cloud</a>, <a href="{{PICTURE}}">picture alone</a></span></figcaption></figure>
{{/OVERLAY}}
</div>
{{/OVERLAYS}}
{{#CLOUD_NOTE}}
<p class="hint" dir="auto">{{TEXT}}</p>
{{/CLOUD_NOTE}}
</section>
